# Fig 33 at 65,536 strands: the paper's networks as printed, on patches of 128 x 128, batch 128, Adam 1e-4
# also: fig33
# needs: cuda
source "$root/scripts/reproduction/learned.bash"
rows_without=(nearest quad core) rows_with=() measured_seeds=(1)
compared_frames=3  # comparing 65,536 strands takes two core minutes a frame and run
UNSEEN_FRAMES=${UNSEEN_FRAMES:-40} PAPER_EPOCHS=${PAPER_EPOCHS:-300}
learned_scene scene11c 16384
