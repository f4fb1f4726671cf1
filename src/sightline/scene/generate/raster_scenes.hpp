// Scenes on which rasterisers are measured (checklist 5.05, 4.07): triangles of a few pixels, layers that fill the
// image, and more triangles than memory holds, by instancing. Each with the view that it is meant for.
#pragma once

#include "sightline/scene/scene.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

struct SceneAndView {
  Scene scene;
  View view;
};

/// 64 displaced spheres and a floor, about a million triangles; 1280 x 720 pixels, depth complexity about 2.6.
SceneAndView spheres_and_floor();

/// `count` quads that fill the image, as objects of two triangles each; object 0 is the farthest.
SceneAndView full_screen_layers(int count);

/// A cube of n^3 instances of one displaced sphere of about 11,900 triangles: n = 36 makes 555 million.
SceneAndView instanced_spheres(int n);

}  // namespace sightline
