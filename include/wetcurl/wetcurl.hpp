/// @file
/// The C++ interface of libwetcurl: simulation.hpp simulates wet hair in another program, learned.hpp runs a
/// network in place of the simulation.
#pragma once

#include "learned.hpp"
#include "simulation.hpp"
