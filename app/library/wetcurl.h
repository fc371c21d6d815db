/* Learned wet hair in another program: a scene and a model, then frame by frame dry low-resolution strands in
 * and wet high-resolution strands out. C interface of libwetcurl; wetcurl.hpp is the same for C++.
 *
 * Lengths in metres, y up. Positions: float[strand][particle][3] in world axes, the root first. A pose:
 * double[7], where the head's origin is and the quaternion that turns it, x y z then w x y z. What returns
 * int gives 0, or -1 where it failed and wetcurl_error() says why. */
#ifndef WETCURL_H
#define WETCURL_H

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define WETCURL_API __attribute__((visibility("default")))
#else
#define WETCURL_API
#endif

typedef struct wetcurl_hair wetcurl_hair;

/* What failed last in this thread, "" where nothing did; good until the next call in it. */
WETCURL_API const char* wetcurl_error(void);

/* scene: TOML, the hair to predict at full resolution, and how wet it is; the dry strands are every second
 * root of its grid each way (wet ones, for a model that learned from wet runs: `wetcurl inspect model` says
 * "low"). model: HDF5, of codec strand. device: "cpu", "cuda" or "cuda:1". threads: 0
 * takes all. NULL where it failed. One hair is for one thread at a time; the threads of networks are the
 * process's, those of the hair opened last. */
WETCURL_API wetcurl_hair* wetcurl_open(const char* scene, const char* model, const char* device, int threads);
WETCURL_API void wetcurl_close(wetcurl_hair* hair);

WETCURL_API int wetcurl_low_strands(const wetcurl_hair* hair);
WETCURL_API int wetcurl_high_strands(const wetcurl_hair* hair);
WETCURL_API int wetcurl_particles(const wetcurl_hair* hair); /* of a strand */
/* The dry strands at rest in the head's frame, [wetcurl_low_strands][wetcurl_particles][3]. */
WETCURL_API void wetcurl_low_at_rest(const wetcurl_hair* hair, float* low);

/* From now on the network is asked only for the rectangle of the root grid that holds all wet strands; the
 * others stay where it starts from. Costs less where little is wet, and errs by more on what is dry. Fails
 * for a network that looks at the whole grid. */
WETCURL_API int wetcurl_crop(wetcurl_hair* hair);

/* Where each frame is read, [low strands][particles][3], and written, [high strands][particles][3].
 * on_device: both are memory of the hair's CUDA device, and nothing is copied to or from the host (what
 * writes `low` must be through before wetcurl_run). */
WETCURL_API int wetcurl_bind(wetcurl_hair* hair, const float* low, float* high, int on_device);

/* One frame of the scene's rate; for every frame of a shot, in order. The head's pose one frame before, now
 * and one after; before and after may be NULL: the head stands still then, as it does in a shot's first
 * frame. Returns when the strands are there. */
WETCURL_API int wetcurl_run(wetcurl_hair* hair, const double before[7], const double now[7],
                            const double after[7]);
/* The next frame is the first of another shot. */
WETCURL_API void wetcurl_restart(wetcurl_hair* hair);

#ifdef __cplusplus
}
#endif
#endif
