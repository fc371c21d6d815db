/* Wet hair simulated in memory: simulate_in_c [DEVICE]. Strands of its own on a ball, which nods for a second
 * in frames of unequal length; prints how far tips hang below the ball's middle on average [m]. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <wetcurl/wetcurl.h>

static const char* scene =
    "[groom]\nparticles = 32\n"
    "[stretch]\n[bend]\n[core]\n"
    "[wetness]\n[curl]\n[cohesion]\n"
    "[[solid]]\nname = \"head\"\nradius = 0.095\nattached = \"head\"\n";

enum { strands = 96, points = 40 };

static void fail(void) {
    fprintf(stderr, "%s\n", wetcurl_error());
    exit(1);
}

/* Strands leave the upper half of the ball and fall, with a wave. */
static void draw(float* x) {
    for (int s = 0; s < strands; ++s) {
        const double turn = 2.399963 * s, height = 0.9 * s / strands, out = sqrt(1 - height * height);
        for (int i = 0; i < points; ++i, x += 3) {
            const double down = 0.2 * i / (points - 1), wave = 0.004 * sin(60 * down) * i / points;
            const double away = 0.0955 * out + 0.02 * (1 - exp(-20 * down)) + wave;
            x[0] = (float)(away * cos(turn));
            x[1] = (float)(0.0955 * height - down * down / (down + 0.02));
            x[2] = (float)(away * sin(turn));
        }
    }
}

int main(int argc, char** argv) {
    static float drawn[strands * points * 3];
    int counts[strands];
    for (int s = 0; s < strands; ++s) counts[s] = points;
    draw(drawn);

    wetcurl_setup* setup = wetcurl_setup_text(scene, ".");
    if (!setup || wetcurl_setup_strands(setup, strands, counts, drawn)) fail();
    wetcurl_simulation* hair = wetcurl_simulate(setup, argc > 1 ? argv[1] : "cpu", "float", 0);
    if (!hair) fail();
    wetcurl_setup_free(setup);

    for (int frame = 0; wetcurl_time(hair) < 1; ++frame) {
        const double seconds = frame % 3 ? 1.0 / 60 : 1.0 / 40, end = wetcurl_time(hair) + seconds;
        const double nod = 0.3 * sin(6 * end);
        const double pose[7] = {0, 0, 0, cos(nod / 2), sin(nod / 2), 0, 0};
        if (wetcurl_move_head(hair, pose) || wetcurl_advance(hair, seconds)) fail();
    }

    const int n = wetcurl_strand_particles(hair), count = wetcurl_strands(hair);
    float* x = malloc(sizeof(float) * 3 * (size_t)n * (size_t)count);
    if (wetcurl_displayed(hair, x)) fail();
    double sum = 0;
    for (int s = 0; s < count; ++s) sum -= (double)x[3 * (n * (s + 1) - 1) + 1];
    printf("%d strands, %.6f\n", count, sum / count);
    free(x);
    wetcurl_simulation_free(hair);
    return 0;
}
