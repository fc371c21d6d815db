/** @file
 * The C interface of libwetcurl: simulation.h simulates wet hair in another program, learned.h runs a network
 * in place of the simulation. wetcurl.hpp is the same for C++. */
#ifndef WETCURL_H
#define WETCURL_H

#include "learned.h"
#include "simulation.h"

#endif
