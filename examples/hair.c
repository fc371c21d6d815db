/* Learned wet hair under a head that turns: hair_in_c SCENE.toml MODEL.h5 [DEVICE]. Its dry strands are
 * stiff: they turn with the head. Prints how far wet tips hang from their roots on average [m]. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <wetcurl/wetcurl.h>

static void head_at(int frame, double pose[7]) {
    const double angle = 0.02 * frame;
    const double values[7] = {0, 0, 0, cos(angle / 2), 0, sin(angle / 2), 0};
    for (int k = 0; k < 7; ++k) pose[k] = values[k];
}

/* About y, as head_at does. */
static void turn(int frame, const float* from, float* to, size_t points) {
    const float c = cosf(0.02f * frame), s = sinf(0.02f * frame);
    for (size_t k = 0; k < points; ++k, from += 3, to += 3) {
        to[0] = c * from[0] + s * from[2];
        to[1] = from[1];
        to[2] = -s * from[0] + c * from[2];
    }
}

int main(int argc, char** argv) {
    if (argc < 3) return fprintf(stderr, "use: hair_in_c SCENE.toml MODEL.h5 [DEVICE]\n"), 2;
    wetcurl_hair* hair = wetcurl_open(argv[1], argv[2], argc > 3 ? argv[3] : "cpu", 0);
    if (!hair) return fprintf(stderr, "%s\n", wetcurl_error()), 1;
    const size_t n = (size_t)wetcurl_particles(hair), low_points = n * (size_t)wetcurl_low_strands(hair),
                 strands = (size_t)wetcurl_high_strands(hair);
    float *rest = malloc(low_points * 3 * sizeof *rest), *low = malloc(low_points * 3 * sizeof *low),
          *high = malloc(strands * n * 3 * sizeof *high);
    wetcurl_low_at_rest(hair, rest);
    if (wetcurl_bind(hair, low, high, 0)) return fprintf(stderr, "%s\n", wetcurl_error()), 1;
    for (int frame = 0; frame < 4; ++frame) {
        double before[7], now[7], after[7];
        head_at(frame - 1, before), head_at(frame, now), head_at(frame + 1, after);
        turn(frame, rest, low, low_points);
        if (wetcurl_run(hair, frame ? before : NULL, now, frame ? after : NULL))
            return fprintf(stderr, "%s\n", wetcurl_error()), 1;
    }
    double sum = 0;
    for (size_t s = 0; s < strands; ++s) {
        const float *root = high + 3 * n * s, *tip = root + 3 * (n - 1);
        sum += sqrt(pow(tip[0] - root[0], 2) + pow(tip[1] - root[1], 2) + pow(tip[2] - root[2], 2));
    }
    printf("%zu strands, %.6f\n", strands, sum / (double)strands);
    free(rest), free(low), free(high);
    wetcurl_close(hair);
    return 0;
}
