/** @file
 * Wet hair simulated in another program, in memory. A setup gathers a scene and what the caller brings along:
 * strands, and meshes that the caller will move. It makes a simulation. Then, frame by frame, the caller
 * says where things are at the frame's end and how long it is, and reads where the strands are.
 * simulation.hpp is the same for C++; api.h says what all interfaces have in common.
 *
 * What is moved goes from where it is to where it is told to be, smoothly: without a jump in velocity from
 * one frame to the next. A thing goes as the scene says until it is moved for the first time; from then on it
 * stands still in frames in which it is not moved. */
#ifndef WETCURL_SIMULATION_H
#define WETCURL_SIMULATION_H

#include "api.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A scene to be simulated, and what the caller brings along. */
typedef struct wetcurl_setup wetcurl_setup;

/** Begins with a scene file (TOML), or returns NULL where there is none. The format: docs/scene.md. */
WETCURL_API wetcurl_setup* wetcurl_setup_file(const char* scene);
/** Begins with the text of a scene; files that it names are looked for in `folder`. */
WETCURL_API wetcurl_setup* wetcurl_setup_text(const char* scene, const char* folder);
/** Frees the setup; simulations made of it stay. NULL is allowed. */
WETCURL_API void wetcurl_setup_free(wetcurl_setup* setup);

/** Changes a key of the scene: "integrator.substeps=20". */
WETCURL_API int wetcurl_setup_set(wetcurl_setup* setup, const char* assignment);
/** Brings strands, in place of those that the scene names.
 *
 * - strands: their number.
 * - points: int[strands], the number of points of each, 2 or more.
 * - positions: float[sum of points][3] [m], in the frame of the head at rest, each strand's root first.
 *
 * The simulation has as many particles on every strand as the scene's `groom.particles` says, evenly along
 * it; its strands keep this order. The memory is copied. */
WETCURL_API int wetcurl_setup_strands(wetcurl_setup* setup, int strands, const int* points,
                                      const float* positions);
/** Brings the mesh of a solid, which the caller may then move vertex by vertex. The scene has a [[solid]] of
 * this name with shape = "mesh" and without a file; where its [groom] says scalp = "the name", roots ride on
 * it.
 *
 * - positions: float[vertices][3] [m], in the solid's frame, as at rest.
 * - corners: int[triangles][3], each a vertex from 0, counter-clockwise as seen from outside.
 *
 * Hair collides with it in the box in which it is at rest, a quarter larger to each side, in the solid's
 * frame; where roots ride on it, as far as hair reaches around them. The memory is copied. */
WETCURL_API int wetcurl_setup_mesh(wetcurl_setup* setup, const char* solid, int vertices,
                                   const float* positions, int triangles, const int* corners);
/** Has the caller move each root by itself, by wetcurl_move_roots(). */
WETCURL_API int wetcurl_setup_drive_roots(wetcurl_setup* setup);

/** A simulation. One thread at a time may use it; several may run in several threads. */
typedef struct wetcurl_simulation wetcurl_simulation;

/** Makes the simulation, at rest where the scene begins, or returns NULL where that failed.
 *
 * - device: "cpu", "cuda" or "cuda:1".
 * - precision: "float", or "double", which is slower.
 * - threads: of the CPU; 0 uses all. */
WETCURL_API wetcurl_simulation* wetcurl_simulate(const wetcurl_setup* setup, const char* device,
                                                 const char* precision, int threads);
/** Frees the simulation. NULL is allowed. */
WETCURL_API void wetcurl_simulation_free(wetcurl_simulation* simulation);

/** Number of strands. */
WETCURL_API int wetcurl_strands(const wetcurl_simulation* simulation);
/** Number of particles of a strand. */
WETCURL_API int wetcurl_strand_particles(const wetcurl_simulation* simulation);
/** The time that is simulated [s]. */
WETCURL_API double wetcurl_time(const wetcurl_simulation* simulation);

/** Where the head is at the end of the next frame, from rest. Fails where roots are moved by themselves or
 * ride on a solid: the head goes with them. */
WETCURL_API int wetcurl_move_head(wetcurl_simulation* simulation, const double pose[7]);
/** The same of a solid, by its name. Fails for one that is attached to the head. */
WETCURL_API int wetcurl_move_solid(wetcurl_simulation* simulation, const char* solid, const double pose[7]);
/** The same of the vertices of a mesh that the caller brought: float[vertices][3] [m] in the solid's frame.
 */
WETCURL_API int wetcurl_move_mesh(wetcurl_simulation* simulation, const char* solid, const float* positions);
/** The same of the roots: double[strands][7], each the pose that takes a strand from rest to there. Fails
 * without wetcurl_setup_drive_roots(). */
WETCURL_API int wetcurl_move_roots(wetcurl_simulation* simulation, const double* poses);
/** How wet the hair is from now on, float[strands][particles] from 0 to 1. Fails for a scene without
 * [wetness.flow], which may leave all of its rates at 0. */
WETCURL_API int wetcurl_wet(wetcurl_simulation* simulation, const float* saturation);

/** Simulates a frame of so many seconds, 0 to 1; 0 is a pause, in which nothing happens and what was moved
 * waits. Substeps are at most as long as the scene's, 1 / (fps substeps). Frames of one length are fastest.
 * Fails where the hair diverged, after which it must not be advanced any more. */
WETCURL_API int wetcurl_advance(wetcurl_simulation* simulation, double seconds);
/** A cut: what was moved is there at once, at rest, and each strand begins anew at its root, in the shape
 * that it has. No time passes but for the scene's `settle_after_cut`. */
WETCURL_API int wetcurl_cut(wetcurl_simulation* simulation);

/** Writes where strands are displayed, float[strands][particles][3] [m]: with the cohesion of wet hair. */
WETCURL_API int wetcurl_displayed(const wetcurl_simulation* simulation, float* positions);
/** Writes where strands are simulated, before that, likewise. */
WETCURL_API int wetcurl_simulated(const wetcurl_simulation* simulation, float* positions);
/** Writes the velocities of the simulated positions, float[strands][particles][3] [m/s]. */
WETCURL_API int wetcurl_velocities(const wetcurl_simulation* simulation, float* velocities);
/** Writes how wet the hair is, float[strands][particles]; 0 where the scene is dry. */
WETCURL_API int wetcurl_saturation(const wetcurl_simulation* simulation, float* saturation);

#ifdef __cplusplus
}
#endif
#endif
