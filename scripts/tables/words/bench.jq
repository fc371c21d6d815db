# Of a file of results/bench: its machine in words, a line by its name, the median of that line [ms].
include "shared";

def machine:
  if .provenance.gpu != "none" then .provenance | device
  else "\(.machine.processor), \(.machine.threads) threads" end;
def entry($name): first(.entries[] | select(.name == $name)) // null;
def median($name): entry($name) | .milliseconds.median // null;
# The bench of a GPU, of all of them.
def gpu: first(.bench[] | select(.provenance.gpu != "none")) // error("results/bench holds no bench of a GPU");
