# Fig 41: adhesion by boundary particles and by the level set, on an inclined plate (also Sec. VI.C)
for method in boundary levelset; do
    simulate compare_$method scenes/compare_$method.toml
    inspected compare_$method
    make compare_$method.scene.json "$root/scenes/compare_$method.toml" -- wetcurl inspect scene "$root/scenes/compare_$method.toml" --json compare_$method.scene.json
done
per_particle() { number compare_$1.scene.json .bytes_per_particle; }
row "memory, boundary particles / level set" "above 1: their number increases significantly" "$(value "$(per_particle boundary) / $(per_particle levelset)")" 1.1 100 \
    "$(short "$(per_particle boundary)") and $(short "$(per_particle levelset)") bytes a particle of the hair; both solids are analytic here, so that no field is stored"
seconds() { number compare_$1.json .seconds_per_frame.median; }
row "time a frame, boundary particles / level set" "above 1" "$(value "$(seconds boundary) / $(seconds levelset)")" 1.1 100 \
    "$(short "$(value "1e3 * $(seconds boundary)")") and $(short "$(value "1e3 * $(seconds levelset)")") ms"
# Second difference over frames of the kinetic energy, root mean square, over its mean.
roughness() { number compare_$1.inspect.json '[.energy_joule[].kinetic] as $e | [range(1; $e | length - 1) | $e[. - 1] - 2 * $e[.] + $e[. + 1] | . * .] | (add / length | sqrt) / ($e | add / length)'; }
row "roughness of the motion, boundary particles / level set" "above 1: bouncing, noisy" "$(value "$(roughness boundary) / $(roughness levelset)")" 1.05 1000 \
    "root mean square second difference of the kinetic energy over frames, over its mean: $(short "$(roughness boundary)") and $(short "$(roughness levelset)")"
picture fig41 compare_boundary.h5 compare_levelset.h5 --frame "$(frame 60)"
