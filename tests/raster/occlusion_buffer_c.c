/* Proves that the C header is C, and that a C program gets answers. Returns 0, or the line that failed. */
#include "sightline/raster/occlusion_buffer.h"

int sightline_test_from_c(void);

int sightline_test_from_c(void) {
  static const float wall[] = {-20, -20, -5, 20, -20, -5, 20, 20, -5, -20, 20, -5};
  static const uint32_t quad[] = {0, 1, 2, 0, 2, 3}, wrong[] = {0, 1, 4};
  static const float away[] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 100, 0, 0};
  static const float lo[] = {-1, -1, -9}, hi[] = {1, 1, -8}, before[] = {-1, -1, -3}, end[] = {1, 1, -2};
  static const float boxes[] = {-1, -1, -9, 1, 1, -8, -1, -1, -3, 1, 1, -2};
  static const float centre[] = {0, 0, -9};
  sightline_occlusion_view view = {{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.0, 0, 0.1, 640, 360, 160, 90, 0};
  uint8_t seen[2] = {7, 7};
  int form;
  sightline_occlusion_buffer* buffer = sightline_occlusion_buffer_create();
  sightline_occluder* occluder = sightline_occluder_create(wall, 4, quad, 2);
  if (!buffer || !occluder) return __LINE__;
  if (sightline_occluder_create(wall, 4, wrong, 1)) return __LINE__;
  for (form = 0; form < 2; ++form) {
    if (sightline_occlusion_begin(buffer, &view) != SIGHTLINE_OK) return __LINE__;
    if (!sightline_occlusion_box(buffer, lo, hi)) return __LINE__;
    if (sightline_occlusion_add(buffer, occluder, away) != SIGHTLINE_OK) return __LINE__;
    if (!sightline_occlusion_box(buffer, lo, hi)) return __LINE__;
    if (form == 0 && sightline_occlusion_add(buffer, occluder, NULL) != SIGHTLINE_OK) return __LINE__;
    if (form == 1 && sightline_occlusion_add_triangles(buffer, wall, 4, quad, 2, NULL) != SIGHTLINE_OK) return __LINE__;
    if (sightline_occlusion_box(buffer, lo, hi)) return __LINE__;
    if (!sightline_occlusion_box(buffer, before, end)) return __LINE__;
    if (sightline_occlusion_oriented_box(buffer, NULL, lo, hi)) return __LINE__;
    if (sightline_occlusion_sphere(buffer, centre, 1.0f)) return __LINE__;
    if (sightline_occlusion_triangle(buffer, lo, hi, centre)) return __LINE__;
    if (sightline_occlusion_boxes(buffer, boxes, 2, seen) != SIGHTLINE_OK) return __LINE__;
    if (seen[0] != 0 || seen[1] != 1) return __LINE__;
  }
  if (sightline_occlusion_add_triangles(buffer, wall, 4, wrong, 1, NULL) != SIGHTLINE_BAD_INPUT) return __LINE__;
  view.near_plane = 0;
  if (sightline_occlusion_begin(buffer, &view) != SIGHTLINE_BAD_INPUT) return __LINE__;
  sightline_occluder_destroy(occluder);
  sightline_occlusion_buffer_destroy(buffer);
  return 0;
}
