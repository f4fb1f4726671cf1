#include "walk_json.hpp"

#include <glm/gtc/type_ptr.hpp>

#include "json.hpp"

namespace sightline::cli {
namespace {

/// Names from files may hold any bytes; what is no UTF-8 is replaced rather than refused.
std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json frame_json(const WalkView& view, const WalkAnswer& answer, bool ids) {
  const bool verified = view.truth.has_value();
  Json json{{"frame", view.frame},
            {"eye", {view.view.eye.x, view.view.eye.y, view.view.eye.z}},
            {"candidates", view.candidates},
            {"frustum", view.frustum},
            {"visible", answer.visible},
            {"truth", or_null(view.truth)},
            {"missed", verified ? Json(answer.missed.size()) : Json(nullptr)},
            {"unpromised", verified ? Json(answer.unpromised) : Json(nullptr)},
            {"missed_ids", verified ? Json(answer.missed) : Json(nullptr)},
            {"missed_samples", verified ? Json(answer.missed_samples) : Json(nullptr)},
            {"cull_ms", answer.cull_ms},
            {"truth_ms", verified ? Json(view.truth_ms) : Json(nullptr)},
            {"move_ms", view.move_ms},
            {"follow_ms", answer.follow_ms},
            {"triangles_submitted", answer.triangles_submitted}};
  if (ids) {
    json["visible_ids"] = answer.visible_ids;
    const glm::dmat4 matrix = view_projection(view.view);
    json["view_projection"] = std::vector<double>(glm::value_ptr(matrix), glm::value_ptr(matrix) + 16);
  }
  return json;
}

Json summary_json(const WalkReport& report, const WalkRun& run) {
  const WalkSummary summary = summarise(report, run);
  Json json{{"missed", or_null(summary.missed)},
            {"overestimate", or_null(summary.overestimate)},
            {"cull_ms_median", or_null(summary.cull_ms_median)},
            {"triangles_fraction", or_null(summary.triangles_fraction)},
            {"follow_ms_median", or_null(summary.follow_ms_median)},
            {"made_anew", run.made_anew},
            {"verdict", summary.verdict},
            {"interrupted", report.interrupted}};
  Json& counters = json["counters"] = Json::object();
  run.counters.each([&](const char* name, std::uint64_t value) { counters[name] = value; });
  return json;
}

Json scene_json(const WalkReport& report) {
  return {{"name", report.scene_name},
          {"objects", report.scene->objects().size()},
          {"triangles", report.scene->triangle_count()}};
}

Json object_json(const Scene& scene, ObjectId id) {
  const Source source = scene.source(id);
  return {{"id", id},
          {"name", scene.name(id)},
          {"source", source.node < 0 ? Json(nullptr) : Json{{"node", source.node}, {"primitive", source.primitive}}}};
}

/// "[a,\nb,\n...]" without building it first.
template <class F>
void write_array(const TextSink& sink, std::size_t count, F&& element) {
  sink("[");
  for (std::size_t i = 0; i < count; ++i) {
    sink(i == 0 ? "\n" : ",\n");
    sink(text_of(element(i)));
  }
  sink("\n]");
}

void write_head(const WalkReport& report, const TextSink& sink) {
  sink("{\"schema\":\"sightline.walk/1\",\n\"size\":" + text_of({report.width, report.height}));
  sink(",\n\"scene\":" + text_of(scene_json(report)));
  sink(",\n\"samples\":" + text_of(report.samples));
  sink(",\n\"moving\":" + text_of(report.moving));
  sink(",\n\"warnings\":" + text_of(report.warnings));
}

/// Everything of a run but its closing brace.
void write_run(const WalkReport& report, const WalkRun& run, bool ids, const TextSink& sink) {
  write_head(report, sink);
  sink(",\n\"method\":" + text_of(run.method) + ",\n\"promise\":" + text_of(to_string(run.promise)));
  sink(",\n\"frames\":");
  write_array(sink, run.answers.size(),
              [&](std::size_t i) { return frame_json(report.views[i], run.answers[i], ids); });
  sink(",\n\"summary\":" + text_of(summary_json(report, run)));
}

}  // namespace

void write_walk_json(const WalkReport& report, bool ids, const TextSink& sink, std::string_view extra) {
  if (report.runs.size() == 1) {
    write_run(report, report.runs.front(), ids, sink);
  } else {
    write_head(report, sink);
    sink(",\n\"runs\":[\n");
    for (std::size_t i = 0; i < report.runs.size(); ++i) {
      if (i > 0) sink(",\n");
      write_run(report, report.runs[i], ids, sink);
      sink("}");
    }
    sink("]");
  }
  if (ids) {
    sink(",\n\"objects\":");
    write_array(sink, report.scene->objects().size(),
                [&](std::size_t i) { return object_json(*report.scene, static_cast<ObjectId>(i)); });
  }
  sink(extra);
  sink("}\n");
}

}  // namespace sightline::cli
