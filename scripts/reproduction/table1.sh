# Table 1: the layers and parameters of the paper's networks
# also: fig16 fig18 fig19 fig20
# A model file lists its layers; the shortest training of all makes one.
small=(--set "groom.grid=[8,8]" --set groom.particles=20 --set integrator.settle=0 --set integrator.substeps=2)
simulate table1_dry scenes/demo.toml --frames "$(frames 6)" --dry --strands 16 "${small[@]}"
simulate table1_wet scenes/demo.toml --frames "$(frames 6)" "${small[@]}"
make table1_pairs.h5 table1_dry.h5 table1_wet.h5 -- wetcurl encode table1_dry.h5 table1_wet.h5 -o table1_pairs.h5 --codec root
for network in unet_vgg19 recursive_residual; do
    make table1_$network.h5 table1_pairs.h5 -- wetcurl train sr table1_pairs.h5 -o table1_$network.h5 --arch $network --width 1 --set epochs=1
    make table1_$network.json table1_$network.h5 -- wetcurl inspect model table1_$network.h5 --json table1_$network.json
done
adhesion=$root/models/weights/adhesion_scene15.h5
make table1_adhesion.json "$adhesion" -- wetcurl inspect model "$adhesion" --json table1_adhesion.json

# What a layer's weights say: shape_of NETWORK LAYER INDEX.
shape_of() { jq -er --arg name "$2.weight" --argjson k "$3" '.weights[] | select(.name == $name) | .shape[$k]' "table1_$1.json"; }
layers_of() { jq --arg block "^$2_[0-9]+[.]weight$" '[.weights[] | select(.name | test($block))] | length' "table1_$1.json"; }

# Table 1 and Figures 19, 20: convolutions of each block, and channels into the first.
table='[]'
while read -r block layers channels; do
    table=$(jq -c --arg block "$block" --argjson paper_layers "$layers" --argjson layers "$(layers_of unet_vgg19 "$block")" \
        --argjson paper_channels "$channels" --argjson channels "$(shape_of unet_vgg19 "${block}_0" 1)" \
        --arg kernel "$(shape_of unet_vgg19 "${block}_0" 2) x $(shape_of unet_vgg19 "${block}_0" 3)" --argjson out "$(shape_of unet_vgg19 "${block}_0" 0)" \
        '. + [{block: $block, "paper: convolutions": $paper_layers, convolutions: $layers, "paper: channels in": $paper_channels, "channels in": $channels, "channels out": $out, kernel: $kernel}]' <<<"$table")
done <<'END'
C1 2 3
C2 2 64
C3 4 128
C4 4 256
C5 4 512
r1 4 576
r2 4 576
r3 4 320
r4 2 192
r5 2 128
r6 2 64
END
numbers "Blocks of unet_vgg19, width 1" "$table"
row "blocks with the paper's convolutions and channels" 11 \
    "$(jq '[.[] | select(.convolutions == ."paper: convolutions" and ."channels in" == ."paper: channels in" and .kernel == "5 x 5")] | length' <<<"$table")" 11 11 \
    "the table below; Table 1's concatenation fits only where skips are taken before the pool"
row "r1 to r6: transposed convolutions of 2 x 2" 6 \
    "$(jq '[.weights[] | select((.name | test("^r[1-6]_up[.]weight$")) and .shape[2:] == [2, 2])] | length' table1_unet_vgg19.json)" 6 6 \
    "64 channels out, each twice as wide and high"
row "r7: channels out" 3 "$(shape_of unet_vgg19 r7 0)" 3 3 "5 x 5 from 64"
row "parameters in all" "not said; its layers have 60,031,235" "$(number table1_unet_vgg19.json .parameters)" 60031235 60031235 \
    "sum over Table 1 and Figure 19: 25 in out + out a convolution"
row "Fig 16: convolutions of the network of ten residual steps" "1 + 20 + 4" \
    "$(jq '[.weights[] | select((.shape | length) == 4 and .shape[2:] == [5, 5])] | length' table1_recursive_residual.json)" 25 25 \
    "recursive_residual, $(jq .parameters table1_recursive_residual.json) parameters; the paper names neither its channels nor its kernels: 64 and 5 x 5 here"
row "Fig 18: neurons of the adhesion network's hidden layers" "6, 5, 4" \
    "$(jq '[.weights[] | select((.shape | length) == 2) | .shape[0]][0:3] | .[0] * 100 + .[1] * 10 + .[2]' table1_adhesion.json)" 654 654 \
    "read as three digits; 12 numbers in, $(jq .parameters table1_adhesion.json) parameters"
