// The occlusion buffer for C: see occlusion_buffer.hpp, whose promises hold here too. No exception leaves a function;
// functions that can fail return 0 for success. World space is right-handed, metres; matrices are column vectors.
#ifndef SIGHTLINE_RASTER_OCCLUSION_BUFFER_H
#define SIGHTLINE_RASTER_OCCLUSION_BUFFER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sightline_occlusion_buffer sightline_occlusion_buffer;
typedef struct sightline_occluder sightline_occluder;

typedef struct sightline_occlusion_view {
  double eye[3], direction[3], up[3]; /* direction of any length > 0; up need not be perpendicular */
  double fov_y;                       /* full vertical angle, radians; 0 for an orthographic view */
  double span_y;                      /* orthographic: height of the image, metres */
  double near_plane;                  /* distance, metres, > 0. What lies beyond the far plane is not asked about. */
  int view_width, view_height;        /* pixels of the image that will be rendered */
  int buffer_width, buffer_height;    /* pixels of the buffer; a quarter of the view's each way is a good start */
  int centres; /* not 0: centres of the buffer's pixels alone count; its size is the view's or k times
                  that: k x k samples in each of the view's pixels */
} sightline_occlusion_view;

enum { SIGHTLINE_OK = 0, SIGHTLINE_BAD_INPUT = 1, SIGHTLINE_NO_MEMORY = 2 };

/* NULL if there is no memory. Destroying NULL does nothing. */
sightline_occlusion_buffer* sightline_occlusion_buffer_create(void);
void sightline_occlusion_buffer_destroy(sightline_occlusion_buffer*);

/* A mesh made ready to hide things, once for all frames: 3 floats per position, 3 indices per triangle. NULL for an
 * index beyond the positions, or if there is no memory. */
sightline_occluder* sightline_occluder_create(const float* positions, size_t position_count, const uint32_t* triangles,
                                              size_t triangle_count);
void sightline_occluder_destroy(sightline_occluder*);

/* Starts a view with nothing hidden. */
int sightline_occlusion_begin(sightline_occlusion_buffer*, const sightline_occlusion_view*);

/* Adds an opaque occluder. `transform`: 12 floats, the columns of a 3 x 4 matrix (x, y and z axis, translation), mesh
 * to world; NULL for the identity. The second form takes triangles as they are. */
int sightline_occlusion_add(sightline_occlusion_buffer*, const sightline_occluder*, const float* transform);
int sightline_occlusion_add_triangles(sightline_occlusion_buffer*, const float* positions, size_t position_count,
                                      const uint32_t* triangles, size_t triangle_count, const float* transform);

/* 0 only if no point of it can be seen; 1 if it may be. lo, hi, centre and corners are 3 floats each. */
int sightline_occlusion_box(const sightline_occlusion_buffer*, const float* lo, const float* hi);
int sightline_occlusion_oriented_box(const sightline_occlusion_buffer*, const float* transform, const float* lo,
                                     const float* hi);
int sightline_occlusion_sphere(const sightline_occlusion_buffer*, const float* centre, float radius);
int sightline_occlusion_triangle(const sightline_occlusion_buffer*, const float* a, const float* b, const float* c);

/* Many boxes with all threads: 6 floats each (lo, hi); seen[i] becomes 0 or 1. */
int sightline_occlusion_boxes(const sightline_occlusion_buffer*, const float* boxes, size_t count, uint8_t* seen);

#ifdef __cplusplus
}
#endif

#endif
