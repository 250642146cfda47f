/* What another renderer asks of woodcock, in C99 and C++, checked against closed forms and constants.
 *
 * A grid whose extinction rises from 0 to 1/4 and falls back over 16 cells: tau = 16 * 1/4 * 1/2 = 2. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "woodcock.h"

enum { PATHS = 4096, SAMPLES = 17 * 2 * 2, MAJORANTS = 64 };

static int failures;

static void check(int holds, const char *what) {
    if (!holds) {
        printf("FAILED: %s\n", what);
        failures++;
    }
}

/* Calls must succeed; where one does not, the library says why. */
static void must(int32_t status) {
    if (status != WOODCOCK_OK) {
        printf("FAILED: %s\n", woodcock_error_text(status));
        failures++;
    }
}

static uint32_t bits(float number) {
    uint32_t word;
    memcpy(&word, &number, sizeof word);
    return word;
}

/* The grid's extinction as a function, for the same ray. */
static float tent(void *data, const float place[3]) {
    unsigned *calls = (unsigned *)data;
    ++*calls;
    return 0.25F * (1.0F - fabsf(place[0] - 8.0F) / 8.0F);
}

static woodcock_stream stream_of(uint32_t pixel, uint32_t sample) {
    woodcock_key key;
    woodcock_stream stream;
    key.seed = 6;
    key.pixel = pixel;
    key.sample = sample;
    must(woodcock_stream_begin(&stream, &key));
    return stream;
}

int main(void) {
    static const float map[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    static const uint32_t dims[3] = {17, 2, 2};
    const float expected = expf(-2.0F);
    /* Four standard errors of ratio tracking under a bound of 1/4: relative variance exp(4/3) - 1; and of counting. */
    const float bound = 4.0F * expected * 1.671F / 64.0F, bound_counted = 4.0F * 0.3421F / 64.0F;
    float samples[SAMPLES], majorants[MAJORANTS] = {0}, sum = 0.0F, field_sum = 0.0F, left = 0.0F, depth = 0.0F, fog;
    float cosines = 0.0F, sigma_t, density;
    unsigned calls = 0;
    uint32_t i, segments = 0;
    woodcock_ray ray = {{-3.0F, 0.5F, 0.5F}, {1.0F, 0.0F, 0.0F}, INFINITY}, within = {{0.0F, 0.5F, 0.5F}, {1.0F, 0.0F, 0.0F}, 16.0F};
    woodcock_grid grid;
    woodcock_walk walk;
    woodcock_segment segment = {0.0F, 0.0F, 0.0F};
    size_t count = woodcock_majorant_count(dims, 4);

    for (i = 0; i < SAMPLES; i++) {
        samples[i] = 0.125F * (float)(i % 17 < 8 ? i % 17 : 16 - i % 17);
    }
    check(count == 6 * 3 * 3, "sizes first");
    must(woodcock_fill_majorants(samples, SAMPLES, dims, 4, majorants, count));
    must(woodcock_open_grid(&grid, samples, SAMPLES, dims, 4, majorants, count, map, 0.25F));

    /* The walk covers the ray without a gap, and its bounds hold. */
    must(woodcock_walk_begin(&walk, &grid, &ray));
    float last = 3.0F;
    while (woodcock_walk_next(&walk, &grid, &segment) == WOODCOCK_OK) {
        check(segment.t0 == last && segment.t1 >= segment.t0, "segments follow each other");
        must(woodcock_walk_extinction(&walk, &grid, 0.5F * (segment.t0 + segment.t1), &sigma_t));
        check(sigma_t <= segment.majorant && sigma_t > 0.0F, "majorants bound");
        depth += sigma_t * (segment.t1 - segment.t0); /* exact: linear on each segment */
        last = segment.t1;
        segments++;
    }
    check(segments == 4 && last == 19.0F && fabsf(depth - 2.0F) < 1e-5F, "four blocks, and tau = 2");

    for (i = 0; i < PATHS; i++) {
        woodcock_stream stream = stream_of(2, i);
        woodcock_flight flight;
        woodcock_scattered scattered;
        float weight;
        must(woodcock_grid_transmittance(&grid, &ray, &stream, &weight));
        sum += weight;
        must(woodcock_field_transmittance(tent, &calls, 0.25F, &within, &stream, &weight));
        field_sum += weight;
        must(woodcock_grid_flight(&grid, &ray, &stream, &flight));
        left += flight.collided ? 0.0F : 1.0F;
        must(woodcock_phase_sample(WOODCOCK_HENYEY_GREENSTEIN, 0.6F, ray.direction, &stream, &scattered));
        cosines += scattered.direction[0];
    }
    printf("transmittance: %.5f on the grid, %.5f by a function, %.5f counted; e^-2 = %.5f\n", (double)(sum / PATHS),
           (double)(field_sum / PATHS), (double)(left / PATHS), (double)expected);
    check(fabsf(sum / PATHS - expected) < bound, "transmittance of the grid");
    check(fabsf(field_sum / PATHS - expected) < bound && calls > PATHS, "transmittance by a function");
    check(fabsf(left / PATHS - expected) < bound_counted, "flights that leave");
    check(fabsf(cosines / PATHS - 0.6F) < 4.0F * 0.5F / 64.0F, "mean cosine");
    /* The bits of the Rust test, tests/bits.rs. */
    printf("bits: %08x %08x\n", (unsigned)bits(sum), (unsigned)bits(cosines));
    check(bits(sum) == 0x4408eb7eU && bits(cosines) == 0x451bb71eU, "the bits of Rust");

    must(woodcock_fog_transmittance(0.5F, 4.0F, &fog));
    check(fabsf(fog - expected) < 1e-7F, "closed form");
    must(woodcock_phase_eval(WOODCOCK_HENYEY_GREENSTEIN, 0.5F, 1.0F, &density));
    check(fabsf(density - 0.75F / (4.0F * 3.14159265F * 0.125F)) < 1e-6F, "Henyey-Greenstein forwards");

    /* Mistakes have codes, and codes have words. */
    check(woodcock_grid_transmittance(NULL, &ray, NULL, NULL) == WOODCOCK_NULL, "NULL");
    check(woodcock_fill_majorants(samples, SAMPLES - 1, dims, 4, majorants, count) == WOODCOCK_LENGTH, "length");
    majorants[18 + 6 + 1] = 0.0F;
    check(woodcock_open_grid(&grid, samples, SAMPLES, dims, 4, majorants, count, map, 1.0F) == WOODCOCK_BOUND, "bound");
    check(strcmp(woodcock_error_text(WOODCOCK_NULL), "a pointer is null") == 0, "text");
    printf(failures == 0 ? "passed\n" : "FAILED\n");
    return failures == 0 ? 0 : 1;
}
