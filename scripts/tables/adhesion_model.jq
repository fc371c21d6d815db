# NAME: the facts of an adhesion network. Errors are root mean squares, over the largest force of Eq 11.
include "shared"; include "models";

models |
{architecture, weights: .parameters, inputs, "trained on": trained_on, seed: recipe("seed"), epochs: recipe("epochs"),
 "best epoch": .numbers.best_epoch, "error on held-out samples": .numbers.validation_nrmse,
 "error there of the force of the step before": .numbers.base_nrmse,
 "error on held-out samples in contact": .numbers.validation_nrmse_in_contact,
 "error there of the force of the step before, in contact": .numbers.base_nrmse_in_contact} |
to_entries | map({"": .key, value}) | table
