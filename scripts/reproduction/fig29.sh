# Fig 29: a ball rises into hair and sinks: wet tips stick to it and are stretched, dry ones are not
# also: scene08 scene08a scene08b
scenes 08a 08b
stretched() { falls "$1" height_mm 'max / .[0]'; }
heights() { echo "$(short "$(falls "$1" height_mm max)") and $(short "$(fall "$1" 0 height_mm)") mm"; }
row "height of the wet hair, most stretched / at rest" "above 1: tips stretch significantly" "$(stretched scene08b)" 1.08 2 "$(heights scene08b)"
row "height of the dry hair, tallest / at rest" "1: no adhesion" "$(stretched scene08a)" 0.98 1.02 "$(heights scene08a)"
picture fig29_up scene08a.h5 scene08b.h5 --frame "$(frame 84)"
picture fig29_down scene08a.h5 scene08b.h5 --frame "$(falls scene08b height_mm 'index(max)')"
