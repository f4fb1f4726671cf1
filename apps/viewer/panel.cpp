#include "viewer/panel.hpp"

#include <imgui.h>

#include <algorithm>

namespace sightline::viewer {
namespace {

constexpr ImGuiWindowFlags quiet = ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;

void text(const std::string& line) { ImGui::TextUnformatted(line.c_str()); }

void methods(Session& session) {
  if (!ImGui::BeginCombo("method (M)", session.method().c_str())) return;
  for (std::size_t i = 0; i < session.methods().size(); ++i)
    if (ImGui::Selectable(session.methods()[i].c_str(), session.methods()[i] == session.method()))
      session.set_method(i);
  ImGui::EndCombo();
}

void legend(const FrameFigures& figures) {
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const ImVec4 colour = ImGui::ColorConvertU32ToFloat4(looks[i].colour);
    ImGui::ColorButton("##colour", colour, ImGuiColorEditFlags_NoTooltip, ImVec2(12, 12));
    ImGui::SameLine();
    ImGui::Text("%8zu %.*s", figures.objects[i], static_cast<int>(looks[i].word.size()), looks[i].word.data());
  }
}

void figures(const Session& session) {
  const FrameFigures& f = session.figures();
  const double share =
      f.scene_triangles == 0 ? 0.0 : 100.0 * static_cast<double>(f.triangles) / static_cast<double>(f.scene_triangles);
  ImGui::Text("%llu of %llu triangles (%.2f %%)", static_cast<unsigned long long>(f.triangles),
              static_cast<unsigned long long>(f.scene_triangles), share);
  ImGui::Text("cull %.2f ms, draw %.2f ms", f.cull_ms, f.draw_ms);
  if (f.queries > 0 || f.draw_calls > 0)
    ImGui::Text("%llu queries, %llu state changes, %llu waits, %llu draw calls",
                static_cast<unsigned long long>(f.queries), static_cast<unsigned long long>(f.state_changes),
                static_cast<unsigned long long>(f.waits), static_cast<unsigned long long>(f.draw_calls));
}

void graph(const std::vector<float>& history) {
  if (history.empty()) return;
  const float most = *std::max_element(history.begin(), history.end());
  char label[64];
  std::snprintf(label, sizeof label, "frame %.1f ms, worst %.1f", static_cast<double>(history.back()),
                static_cast<double>(most));
  ImGui::PlotLines("##frames", history.data(), static_cast<int>(history.size()), 0, label, 0.0f, 1.1f * most,
                   ImVec2(320, 60));
}

void modes(const Session& session) {
  std::string on;
  for (const auto& [is_on, word] : {std::pair{session.frozen(), "culling frozen (C)"},
                                    {session.colours_by_standing(), "colours by verdict (V)"},
                                    {session.shows_bounds(), "bounds (B)"},
                                    {session.shows_depth(), "depth (Z)"},
                                    {session.shows_queries(), "queries (Q)"},
                                    {session.playing(), "playing (space)"}})
    if (is_on) on += (on.empty() ? "" : ", ") + std::string(word);
  if (!on.empty()) text(on);
}

void command_line(const Session& session) {
  const std::string line = session.command_line();
  if (ImGui::SmallButton("copy")) ImGui::SetClipboardText(line.c_str());
  ImGui::SameLine();
  ImGui::PushTextWrapPos(340.0f);
  text(line);
  ImGui::PopTextWrapPos();
}

void answer(const Session& session) {
  if (session.explanation().empty()) return;
  const ImGuiIO& io = ImGui::GetIO();
  ImGui::SetNextWindowPos(ImVec2(io.DisplaySize.x - 10, 10), ImGuiCond_Always, ImVec2(1, 0));
  ImGui::Begin("why?", nullptr, quiet);
  ImGui::PushTextWrapPos(std::max(200.0f, std::min(560.0f, io.DisplaySize.x - 420.0f)));
  text(session.explanation());
  ImGui::PopTextWrapPos();
  ImGui::End();
}

void help() {
  const ImGuiIO& io = ImGui::GetIO();
  ImGui::SetNextWindowPos(ImVec2(0.5f * io.DisplaySize.x, 0.5f * io.DisplaySize.y), ImGuiCond_Always,
                          ImVec2(0.5f, 0.5f));
  ImGui::Begin("keys", nullptr, quiet);
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const auto& [key, what] : Session::keys()) {
      ImGui::TableNextColumn();
      text(key);
      ImGui::TableNextColumn();
      text(what);
    }
    ImGui::EndTable();
  }
  ImGui::End();
}

}  // namespace

void show_panel(Session& session) {
  ImGui::SetNextWindowPos(ImVec2(10, 10), ImGuiCond_Always);
  ImGui::Begin("sightline", nullptr, quiet);
  methods(session);
  legend(session.figures());
  figures(session);
  graph(session.history());
  modes(session);
  command_line(session);
  text("? shows the keys");
  ImGui::End();
  answer(session);
  if (session.help()) help();
}

}  // namespace sightline::viewer
