# Of a file of results/learned: a row by its name, and the errors that networks are compared with.
include "shared";

def row($name): first(.rows[] | select(.name == $name)) // null;
def error_mm: .position_mm.mean;
def jitter: if .jitter_mm == null or .jitter_reference_mm == null then null else .jitter_mm / .jitter_reference_mm end;
def quad: row("quad") | error_mm;
# The smallest error without a network, from the dry low-resolution run.
def best:
  [.rows[] | select(.kind == "interpolated" and (.name | startswith("wet_low") | not)) | error_mm] | min;
# Of a list of files.
def made_of:
  "*Errors: \(map(.provenance | "\(.date), revision \(.revision), \(.processor)") | unique | join("; ")).*";
