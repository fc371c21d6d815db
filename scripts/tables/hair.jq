# Kinds of hair by name, and what the program makes of them: results/hair/*.json.
include "shared"; include "hair";

kinds | map({
  kind: "`\(.hair)`", "what it is": .about,
  "diameter [µm]": (1e6 * .diameter), "axes": .ellipticity,
  "curl radius, pitch [mm]": (if .curl_radius > 0 then "\(1000 * .curl_radius | short), \(1000 * .pitch | short)" else "straight" end),
  "EI dry, wet [nN m²]": "\(1e9 * .flexural_rigidity | short), \(1e9 * .wet_flexural_rigidity | short)",
  "GJ dry, wet [nN m²]": "\(1e9 * .torsional_rigidity | short), \(1e9 * .wet_torsional_rigidity | short)",
  "height drawn, dry, wet [mm]": "\(.dry.drawn.height_mm | short), \(.dry.last.height_mm | short), \(.wet.last.height_mm | short)",
  "axial extent, wet by dry": (.wet.last.axial_extent_mm / .dry.last.axial_extent_mm)}) | table
