#include "xr/runtime/state.h"

#include <algorithm>

namespace binosplat::xr_test {

Runtime::Runtime() : script(read_script()) {
  if (!script.folder.empty()) log_.open(script.folder / "log.jsonl", std::ios::app);
  locals.emplace_back(0, script.local);
}

Runtime::~Runtime() {
  if (objects.empty()) return;
  Json left = Json::array();
  for (const auto& [id, object] : objects) left.push_back(object->kind() + (" " + std::to_string(id)));
  log({{"what", "left"}, {"objects", left}});
}

Runtime& runtime() {
  static Runtime the_runtime;
  return the_runtime;
}

Instance* Runtime::instance() {
  for (const auto& [id, object] : objects) {
    if (auto* found = dynamic_cast<Instance*>(object.get())) return found;
  }
  return nullptr;
}

Session* Runtime::session() {
  for (const auto& [id, object] : objects) {
    if (auto* found = dynamic_cast<Session*>(object.get())) return found;
  }
  return nullptr;
}

void Runtime::check_lost(const Object& object) {
  if (instance_lost_) throw Refusal{XR_ERROR_INSTANCE_LOST, "", false};
  const Session* of = session();
  if (of != nullptr && of->lost && dynamic_cast<const Instance*>(&object) == nullptr) {
    throw Refusal{XR_ERROR_SESSION_LOST, "", false};
  }
}

void Runtime::destroy(Object& object) {
  Json alive = Json::array();
  // Children of children first; ids grow from parents to children.
  std::vector<std::uint64_t> doomed = {object.id};
  for (std::size_t done = 0; done < doomed.size();) {
    const std::uint64_t parent = doomed[done++];
    for (const auto& [id, child] : objects) {
      if (child->parent == parent) doomed.push_back(id);
    }
  }
  // A set's actions go with it, as everybody lets them.
  const bool set = dynamic_cast<ActionSet*>(&object) != nullptr;
  for (const std::uint64_t id : doomed) {
    if (id != object.id && !set) alive.push_back(objects[id]->kind() + (" " + std::to_string(id)));
  }
  log({{"what", "destroyed"}, {"kind", object.kind()}, {"id", object.id}, {"alive", alive}});
  std::reverse(doomed.begin(), doomed.end());
  for (const std::uint64_t id : doomed) {
    auto* swapchain = dynamic_cast<Swapchain*>(objects[id].get());
    const Session* of = session();
    if (swapchain != nullptr && of != nullptr) {
      const Current current(of->binding);
      of->binding.DeleteTextures(static_cast<GLsizei>(swapchain->textures.size()),
                                 swapchain->textures.data());
    }
    objects.erase(id);
  }
}

int Runtime::frame() {
  const Session* of = session();
  if (of == nullptr) return 0;
  if (of->begun) return of->begun->number;
  return of->waited ? of->waited->number : next_frame;
}

int Runtime::frame_of(XrTime time) const {
  const XrDuration since = std::max<XrDuration>(time - script.first_time, 0);
  return static_cast<int>((since + script.period / 2) / script.period);
}

std::optional<XrResult> Runtime::scripted_result() {
  for (Json& event : script.events) {
    if (!event.contains("fail") || event["fail"] != function || event.value("frame", 0) > frame()) continue;
    const int times = event.value("times", 1'000'000);
    if (times == 0) continue;
    event["times"] = times - 1;
    const XrResult result = result_from(event.at("result"));
    log({{"what", "scripted"}, {"function", function}, {"result", name_of(result)}, {"frame", frame()}});
    if (result == XR_ERROR_SESSION_LOST && session() != nullptr) session()->lost = true;
    if (result == XR_ERROR_INSTANCE_LOST) instance_lost_ = true;
    return result;
  }
  return std::nullopt;
}

void Runtime::log(const Json& line) {
  if (log_.is_open()) log_ << line.dump() << std::endl;
}

void Runtime::fault(const std::string& text, XrResult result) {
  Session* of = session();
  const int at = frame();
  if (of != nullptr && (of->begun || of->waited)) {
    (of->begun ? of->begun : of->waited)->faults.push_back(std::string(function) + ": " + text);
  }
  log({{"what", "fault"},
       {"function", function},
       {"frame", at},
       {"result", name_of(result)},
       {"text", text}});
}

}  // namespace binosplat::xr_test
