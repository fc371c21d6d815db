# Fig 30: the ball in denser hair, adhesion alone
# also: scene09
scenes 09
simulate scene09_dry scenes/scene09.toml --dry
inspected scene09_dry
tallest() { number "$1.inspect.json" '[.fall[].height_mm] | max'; }
rest() { number "$1.inspect.json" '.fall[0].height_mm'; }
row "height of the wet hair, most stretched / at rest" "above 1: adhesion stretches" "$(value "$(tallest scene09) / $(rest scene09)")" 1.08 2 \
    "$(short "$(tallest scene09)") and $(short "$(rest scene09)") mm"
row "height of the dry hair, tallest / at rest" "1: no adhesion" "$(value "$(tallest scene09_dry) / $(rest scene09_dry)")" 0.98 1.02 \
    "$(short "$(tallest scene09_dry)") and $(short "$(rest scene09_dry)") mm"
picture fig30_up scene09.h5 scene09_dry.h5 --frame "$(frame 84)"
picture fig30_down scene09.h5 scene09_dry.h5 --frame "$(frame 140)"
