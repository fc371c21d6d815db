# Targets of frames by machine and of single networks. A quantity that was not measured is left out.
include "shared"; include "bench"; include "learned";

def judged($what; $high; f):
  {"": $what, target: "at most \($high)", measured: f} | select(.measured != null) | . + {met: (.measured <= $high)};
def frames($what; $high; $name): judged("\(machine): \($what) [ms]"; $high; median($name));

[(.bench[] |
   if .provenance.gpu != "none" then
     frames("wet frame of 9900 x 100"; 1.5; "wet frame, 9900 strands"),
     frames("the same with one pass of Eq 10"; 0.6; "wet frame, Eq 10 with passes = 1, 9900 strands"),
     frames("wet frame of 512 x 100"; 0.3; "wet frame, 512 strands"),
     frames("wet frame of 100,000 x 100"; 16; "wet frame, 100000 strands"),
     frames("one patch through `unet_vgg19`"; 0.5; "network unet_vgg19, patch of 128 x 128"),
     judged("\(machine): bytes per particle, 9900 x 100 wet"; 220; entry("wet frame, 9900 strands").bytes_per_particle)
   else
     frames("wet frame of 512 x 100"; 20; "wet frame, 512 strands"),
     frames("`displayed_s`, 2048 x 100"; 30; "learned frame, 2048 strands, displayed_s")
   end),
 (.learned.from_10_substeps | ("strand_m_wet", "displayed_m_wet") as $network |
   judged("`\($network)` from a wet run: error over quad interpolation of the dry run"; 0.22;
     (row($network) | error_mm) / quad)),
 (.reproduction.scene15 |
   judged("adhesion network beside Eq 11: largest difference of the distance to the solid [mm]"; 1;
     first(.rows[] | select(.what | test("at most")).ours)))] | table
