/* woodcock.h: unbiased free flights, transmittance, phase functions and majorant grids.
 *
 * C99 and C++. No heap, no threads, no global state: every object lies in memory of yours, and any number of threads may call with objects
 * of their own; an opened grid and its tables may be shared, being only read.
 *
 *   cargo rustc --profile embedded -p woodcock-c --crate-type staticlib     makes  target/embedded/libwoodcock_c.a
 *   cc -Icore/c/include program.c target/embedded/libwoodcock_c.a
 *
 * Every function checks its arguments, answers with a code of enum woodcock_status, and writes results only where that is WOODCOCK_OK, or
 * not at all. Nothing can panic, unwind or call back (but for woodcock_extinction). Pointers must lead to what their types say;
 * NULL, misalignment and wrong lengths are found out, wild pointers cannot be. Lengths are in any unit, coefficients per the same. All
 * results are the same bits on every machine.
 */
#ifndef WOODCOCK_H
#define WOODCOCK_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What became of a call; woodcock_error_text says it in words. */
enum woodcock_status {
    WOODCOCK_OK = 0,
    WOODCOCK_END = 1,         /* a walk has come to the end of its ray; no error */
    WOODCOCK_NULL = 2,        /* a pointer is NULL */
    WOODCOCK_ALIGNMENT = 3,   /* a pointer is not aligned to its type */
    WOODCOCK_OVERLAP = 4,     /* memory to write to overlaps memory to read from */
    WOODCOCK_RAY = 5,         /* origin not finite, direction no unit vector, or length negative or NaN */
    WOODCOCK_EXTINCTION = 6,  /* negative, infinite or NaN, or beyond its bound */
    WOODCOCK_PHASE = 7,       /* no such phase function */
    WOODCOCK_MEAN_COSINE = 8, /* not between -1 and 1 */
    WOODCOCK_COSINE = 9,      /* not from -1 to 1 */
    WOODCOCK_DIMENSIONS = 10, /* fewer than two samples along an axis, or more than 2^31 in all */
    WOODCOCK_EDGE = 11,       /* not 4, 8, 16, 32 or 64 */
    WOODCOCK_LENGTH = 12,     /* a table of another length than the dimensions ask for */
    WOODCOCK_SAMPLE = 13,     /* negative, NaN, or beyond 3.4e38 */
    WOODCOCK_BOUND = 14,      /* a majorant that does not bound the samples of its block */
    WOODCOCK_RIM = 15,        /* a majorant of the rim that is not zero */
    WOODCOCK_LEAP = 16,       /* a majorant below zero that is no leap over empty blocks */
    WOODCOCK_PLACEMENT = 17,  /* a map or a scale that is not finite, or a scale negative or too large */
    WOODCOCK_UNOPENED = 18,   /* the grid was not opened, or the walk not begun */
    WOODCOCK_WORK = 19,       /* more than 1e7 tentative collisions would be expected on the ray */
    WOODCOCK_OTHER = 20       /* an error that this interface has no code for */
};

/* A status in words, any number: never NULL, not to be freed. */
const char *woodcock_error_text(int32_t status);

/* --- random numbers -------------------------------------------------------------------------------------- */

/* What identifies a stream: the numbers of a key are the same wherever and whenever they are drawn. */
typedef struct woodcock_key {
    uint64_t seed;
    uint32_t pixel;  /* or whatever is computed apart */
    uint32_t sample; /* of that pixel */
} woodcock_key;

/* A stream; its contents are not yours to read, but may be copied. */
typedef struct woodcock_stream {
    uint64_t opaque[2];
} woodcock_stream;

/* Puts the stream of a key at its beginning. */
int32_t woodcock_stream_begin(woodcock_stream *stream, const woodcock_key *key);
/* Uniform in [0, 1), on the grid k / 2^24. One draw. */
int32_t woodcock_uniform(woodcock_stream *stream, float *u);
/* Exponentially distributed, mean one: a free flight in mean free paths. */
int32_t woodcock_exponential(woodcock_stream *stream, float *e);

/* --- rays and flights ------------------------------------------------------------------------------------ */

typedef struct woodcock_ray {
    float origin[3];
    float direction[3]; /* a unit vector, to a part in ten thousand */
    float t_max;        /* how long it is; INFINITY serves where the medium ends */
} woodcock_ray;

typedef struct woodcock_flight {
    float t;           /* the distance to the collision, or t_max */
    uint32_t collided; /* 1 or 0 */
} woodcock_flight;

/* --- homogeneous media ----------------------------------------------------------------------------------- */

/* A free flight in closed form. One exponential draw. */
int32_t woodcock_fog_flight(float sigma_t, float t_max, woodcock_stream *stream, woodcock_flight *flight);
/* exp(-sigma_t t): no draws, no variance. */
int32_t woodcock_fog_transmittance(float sigma_t, float t, float *transmittance);

/* --- media of your own ----------------------------------------------------------------------------------- */

/* The extinction at a place, from 0 to the bound that is given with it; it must return, not throw nor jump. */
typedef float (*woodcock_extinction)(void *data, const float place[3]);

/* A free flight by delta tracking under a bound on the extinction of the whole ray. */
int32_t woodcock_field_flight(woodcock_extinction extinction, void *data, float majorant, const woodcock_ray *ray,
                              woodcock_stream *stream, woodcock_flight *flight);
/* An unbiased estimate of transmittance, in [0, 1], by ratio tracking: average many. */
int32_t woodcock_field_transmittance(woodcock_extinction extinction, void *data, float majorant, const woodcock_ray *ray,
                                     woodcock_stream *stream, float *weight);

/* --- grids ----------------------------------------------------------------------------------------------- */

/* Samples lie at the integers of grid space, x fastest; between them is their trilinear interpolant, around them nothing. Majorants
 * bound it in blocks of edge^3 cells, edge being 4, 8 (a good choice), 16, 32 or 64. Both tables are yours; nothing is copied.
 */

/* An opened grid; its contents are not yours to read, but may be copied. */
typedef struct woodcock_grid {
    uint64_t opaque[24];
} woodcock_grid;

/* How many majorants a grid needs; 0 where there can be no such grid. */
size_t woodcock_majorant_count(const uint32_t dims[3], uint32_t edge);
/* Computes the majorants, and where blocks are empty how far rays may leap. The table must have been written before, zeros will do. */
int32_t woodcock_fill_majorants(const float *samples, size_t sample_count, const uint32_t dims[3], uint32_t edge,
                                float *majorants, size_t majorant_count);
/* Proves that every majorant bounds the samples of its block, and keeps where both tables lie: they must stay, unchanged.
 * world_to_grid: three rows of four numbers, the last of each being the translation. scale: extinction of a sample of one. */
int32_t woodcock_open_grid(woodcock_grid *grid, const float *samples, size_t sample_count, const uint32_t dims[3],
                           uint32_t edge, const float *majorants, size_t majorant_count, const float *world_to_grid,
                           float scale);
/* A free flight by delta tracking; the ray may begin and end anywhere. */
int32_t woodcock_grid_flight(const woodcock_grid *grid, const woodcock_ray *ray, woodcock_stream *stream,
                             woodcock_flight *flight);
/* An unbiased estimate of transmittance, in [0, 1], by ratio tracking: average many. */
int32_t woodcock_grid_transmittance(const woodcock_grid *grid, const woodcock_ray *ray, woodcock_stream *stream,
                                    float *weight);

/* A walk over the majorant segments of a ray, for trackers of your own. */
typedef struct woodcock_walk {
    uint64_t opaque[24];
} woodcock_walk;

typedef struct woodcock_segment {
    float majorant; /* no extinction on the segment is larger */
    float t0, t1;   /* distances along the ray; t1 >= t0, and each segment begins where the one before ended */
} woodcock_segment;

/* Puts a walk where a ray enters a grid. */
int32_t woodcock_walk_begin(woodcock_walk *walk, const woodcock_grid *grid, const woodcock_ray *ray);
/* The next segment, or WOODCOCK_END. The grid is the one that the walk was begun in. By rounding the last segment may be a hair that lies
 * beyond the grid, with a majorant of zero. */
int32_t woodcock_walk_next(woodcock_walk *walk, const woodcock_grid *grid, woodcock_segment *segment);
/* The extinction at a distance along the ray that lies in the segment given last. */
int32_t woodcock_walk_extinction(const woodcock_walk *walk, const woodcock_grid *grid, float t, float *sigma_t);

/* --- phase functions ------------------------------------------------------------------------------------- */

enum woodcock_phase {
    WOODCOCK_ISOTROPIC = 0,
    WOODCOCK_HENYEY_GREENSTEIN = 1, /* g: the mean cosine, between -1 and 1; the others ignore it */
    WOODCOCK_RAYLEIGH = 2
};

typedef struct woodcock_scattered {
    float direction[3]; /* a unit vector */
    float density;      /* over the sphere [1/sr], which is also the phase function's value */
} woodcock_scattered;

/* The value at the cosine between the directions of travel before and after: forward is +1. */
int32_t woodcock_phase_eval(int32_t phase, float g, float cos_theta, float *density);
/* A direction of travel after a collision. Two draws. */
int32_t woodcock_phase_sample(int32_t phase, float g, const float direction[3], woodcock_stream *stream,
                              woodcock_scattered *scattered);

#ifdef __cplusplus
}
#endif
#endif
