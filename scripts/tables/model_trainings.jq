# NAME...: how each network was trained.
include "shared"; include "models";

[models |
  {"": "`\(.name)`", "trained on": trained_on, seed: recipe("seed"), epochs: recipe("epochs"), "best epoch": .numbers.best_epoch,
   "learning rate": recipe("learning_rate"), batch: recipe("batch"), precision: recipe("precision")}] | table
