// Which compared methods a scene names: reading and checking its [baseline].
#pragma once

#include "solver/scene/scene.h"

namespace wetcurl {

// The rows of [baseline], in the order of the list of methods.
std::vector<KeyRow> baseline_rows();

// The named methods with their rows, before the tables that one is a preset of are read. Throws Misuse with
// file and line.
void read_baselines(Scene& scene, const Table& root);
// After all tables are read: what a method is, or stands in the place of, must not be named otherwise. Sets
// the forms that a method is a preset of. Throws Misuse with file and line.
void check_baselines(Scene& scene, const Table& root);

}  // namespace wetcurl
