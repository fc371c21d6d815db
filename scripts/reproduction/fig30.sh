# Fig 30: the ball in denser hair, adhesion alone
# also: scene09
scenes 09
simulate scene09_dry scenes/scene09.toml --dry
inspected scene09_dry
stretched() { falls "$1" height_mm 'max / .[0]'; }
heights() { echo "$(short "$(falls "$1" height_mm max)") and $(short "$(fall "$1" 0 height_mm)") mm"; }
row "height of the wet hair, most stretched / at rest" "above 1: adhesion stretches" "$(stretched scene09)" 1.08 2 "$(heights scene09)"
row "height of the dry hair, tallest / at rest" "1: no adhesion" "$(stretched scene09_dry)" 0.98 1.02 "$(heights scene09_dry)"
picture fig30_up scene09_dry.h5 scene09.h5 --frame "$(frame 84)"
picture fig30_down scene09_dry.h5 scene09.h5 --frame "$(falls scene09 height_mm 'index(max)')"
