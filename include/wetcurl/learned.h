/** @file
 * Learned wet hair in another program. A scene and a model make a hair; then, frame by frame, dry strands of
 * low resolution go in and wet strands of high resolution come out. learned.hpp is the same for C++; api.h
 * says what all interfaces have in common. */
#ifndef WETCURL_LEARNED_H
#define WETCURL_LEARNED_H

#include "api.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The hair of a scene with its network. One thread at a time may use it. */
typedef struct wetcurl_hair wetcurl_hair;

/** Which strands of a scene are simulated for the network to follow. */
typedef struct wetcurl_low_run {
    int stride;   /**< Every so many roots each way of the scene's grid, 2 or more. Not read with guides. */
    int guides;   /**< Above 0: so many strands in their place, chosen where hair differs. */
    int substeps; /**< Of a frame of their simulation. 0: the scene's. */
} wetcurl_low_run;

/** Equal pieces of a strand, of which each has an expected error. */
#define WETCURL_ERROR_PIECES 8

/** Makes a hair, or returns NULL where that failed.
 *
 * - scene: a scene file (TOML). It describes the hair to predict, at full resolution, and how wet it is. The
 * dry strands are every second root of its grid each way, and are taken to be simulated in the scene's
 * substeps.
 * - model: a model file (HDF5) of codec strand. Where `wetcurl inspect model` prints low = "wet", it reads
 * wet strands of low resolution in place of dry ones.
 * - device: "cpu", "cuda" or "cuda:1".
 * - threads: 0 uses all. The network's threads are shared by the process: the hair opened last sets them. */
WETCURL_API wetcurl_hair* wetcurl_open(const char* scene, const char* model, const char* device, int threads);
/** The same, from other strands. */
WETCURL_API wetcurl_hair* wetcurl_open_from(const char* scene, const char* model, const char* device,
                                            int threads, wetcurl_low_run low);
/** Frees the hair. NULL is allowed. */
WETCURL_API void wetcurl_close(wetcurl_hair* hair);

/** Number of strands that are read. */
WETCURL_API int wetcurl_low_strands(const wetcurl_hair* hair);
/** Number of strands that are written. */
WETCURL_API int wetcurl_high_strands(const wetcurl_hair* hair);
/** Number of particles of a strand, read or written. */
WETCURL_API int wetcurl_particles(const wetcurl_hair* hair);
/** Writes the strands of low resolution at rest to `low`, float[low strands][particles][3] [m] in the head's
 * frame. */
WETCURL_API void wetcurl_low_at_rest(const wetcurl_hair* hair, float* low);
/** Writes which of the scene's strands these are, int[low strands], counted from 0. */
WETCURL_API void wetcurl_low_places(const wetcurl_hair* hair, int* places);

/** From now on, the network computes only the rectangle of the root grid that holds all wet strands; the
 * others stay where interpolation puts them. This is faster where little is wet, and less accurate for dry
 * strands. Fails for a network that reads the whole grid. */
WETCURL_API int wetcurl_crop(wetcurl_hair* hair);
/** From now on, wet strands are drawn into locks by so many passes of Eq 10 on a grid, in the place of Eq 10
 * by neighbours, which takes longer and follows networks of strands before it by itself. About as many passes
 * as the scene has after such a network, half as many after one of displayed strands. Comes before
 * wetcurl_bind. Fails on a CUDA device, where the scene has no [cohesion], and where a solid does not move
 * with the head. */
WETCURL_API int wetcurl_locks(wetcurl_hair* hair, int passes);

/** Sets where each frame is read, float[low strands][particles][3], and written, float[high
 * strands][particles][3] [m]. The memory stays the caller's and must outlive the runs.
 *
 * on_device: 0 for host memory. Otherwise both are memory of the hair's CUDA device, and nothing is copied to
 * or from the host; kernels that write `low` must have ended before wetcurl_run. */
WETCURL_API int wetcurl_bind(wetcurl_hair* hair, const float* low, float* high, int on_device);

/** Computes one frame of a shot. A shot's frames come in order, at the scene's rate. Returns when the strands
 * are written.
 *
 * `before`, `now` and `after` are the head's poses one frame earlier, now and one frame later. In a shot's
 * first frame `before` and `after` are NULL: the head does not move. */
WETCURL_API int wetcurl_run(wetcurl_hair* hair, const double before[7], const double now[7],
                            const double after[7]);
/** Writes how far from the simulation the network expects the frame run last to be: float[high
 * strands][WETCURL_ERROR_PIECES] [m], the mean over each piece of a strand, root first. Fails before a frame
 * was run, and after wetcurl_crop: of what is not computed nothing is known. */
WETCURL_API int wetcurl_expected_errors(wetcurl_hair* hair, float* errors);
/** The next frame is the first of another shot. */
WETCURL_API void wetcurl_restart(wetcurl_hair* hair);

#ifdef __cplusplus
}
#endif
#endif
