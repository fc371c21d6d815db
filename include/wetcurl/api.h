/** @file
 * What the interfaces of libwetcurl have in common.
 *
 * Lengths are in metres, y is up. Positions are float[strand][particle][3] in world axes, the root first. A
 * pose is double[7]: the origin x y z [m], then the unit quaternion w x y z of the rotation.
 *
 * A function that returns int returns 0, or -1 where it failed; wetcurl_error() then says why.
 *
 * Programs built with one release run with every later one of the same minor version (0.1.x). */
#ifndef WETCURL_API_H
#define WETCURL_API_H

/** Marks what the library shows. */
#if defined(__GNUC__)
#define WETCURL_API __attribute__((visibility("default")))
#else
#define WETCURL_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Why this thread's last call failed, "" where it did not. Valid until the thread's next call. */
WETCURL_API const char* wetcurl_error(void);

#ifdef __cplusplus
}
#endif
#endif
