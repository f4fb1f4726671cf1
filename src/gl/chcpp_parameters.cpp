#include <string>

#include "gl/chcpp.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline::gl {

std::unique_ptr<Method> make_chcpp(SceneDrawing& drawing, ParameterReader& parameters) {
  ChcppConfig config;
  config.deterministic = drawing.context().software();
  config.batch = config.deterministic ? 0 : 50;
  if (config.deterministic) config.tight.depth = 0;  // in software boxes cost more than the objects that they save
  std::string form = "paper";
  int largest = static_cast<int>(config.multiquery.largest);
  parameters.read("deterministic", config.deterministic);
  parameters.read("batch", config.batch, 0, 1 << 20);
  parameters.read("multiqueries", config.multiqueries);
  parameters.read("value", form);
  parameters.read("measured", config.measured);
  parameters.read("c1", config.multiquery.c1, 0.0, 1e6);
  parameters.read("largest", largest, 1, 1 << 20);
  parameters.read("assumed", config.assumed, 0, 1000);
  parameters.read("random", config.random);
  parameters.read("adapt", config.adapt);
  parameters.read("query_cost", config.query_cost, 1, 1 << 30);
  parameters.read("sigma", config.tight.sigma, 0.0, 100.0);
  parameters.read("depth", config.tight.depth, 0, 10);
  parameters.read("open", config.open, 1, 30);
  parameters.read("threshold", config.threshold, 1, 1 << 24);
  parameters.read("seed", config.seed, 0, 1 << 30);
  parameters.finish();
  if (form != "paper" && form != "slides") throw InputError("", "gl_chcpp: value", "must be paper or slides");
  config.multiquery.form = form == "paper" ? ValueForm::paper : ValueForm::slides;
  config.multiquery.largest = static_cast<std::size_t>(largest);
  return make_chcpp(drawing, config);
}

}  // namespace sightline::gl
