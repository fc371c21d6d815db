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
bounce() { number compare_$1.inspect.json .bounce_mm; }
row "bouncing on the plate, boundary particles / level set" "above 1: bouncing, no smooth motion" "$(value "$(bounce boundary) / $(bounce levelset)")" 1.05 1000 \
    "root mean square second difference over frames of the distance to the plate, of particles that lie on it: $(short "$(bounce boundary)") and $(short "$(bounce levelset)") mm"
picture fig41 compare_boundary.h5 compare_levelset.h5 --frame "$(frame 60)"
