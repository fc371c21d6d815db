# Fig 29: a ball rises into hair and sinks: wet tips stick to it and are stretched, dry ones are not
# also: scene08 scene08a scene08b
scenes 08a 08b
tallest() { number "$1.inspect.json" '[.fall[].height_mm] | max'; }
rest() { number "$1.inspect.json" '.fall[0].height_mm'; }
row "height of the wet hair, most stretched / at rest" "above 1: tips stretch significantly" "$(value "$(tallest scene08b) / $(rest scene08b)")" 1.08 2 \
    "$(short "$(tallest scene08b)") and $(short "$(rest scene08b)") mm"
row "height of the dry hair, tallest / at rest" "1: without adhesion" "$(value "$(tallest scene08a) / $(rest scene08a)")" 0.98 1.02 \
    "$(short "$(tallest scene08a)") and $(short "$(rest scene08a)") mm"
picture fig29_up scene08a.h5 scene08b.h5 --frame "$(frame 84)"
picture fig29_down scene08a.h5 scene08b.h5 --frame "$(frame 130)"
