// The makers of all kinds, one file each; the table is in generate.cpp. Configs are checked before.
#pragma once

#include "sightline/scene/generate/generate.hpp"

namespace sightline {

Scene generate_building(const GenerateConfig& config);
Scene generate_city(const GenerateConfig& config);
Scene generate_forest(const GenerateConfig& config);
Scene generate_layers(const GenerateConfig& config);
Scene generate_plant(const GenerateConfig& config);
Scene generate_soup(const GenerateConfig& config);

}  // namespace sightline
