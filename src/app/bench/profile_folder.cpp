#include <deque>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/bench/profile.h"
#include "app/bench/report.h"
#include "app/command.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/output_file.h"

namespace binosplat::app {

void save_profile(const std::filesystem::path& folder, const lab::Profile& profile,
                  const std::vector<std::string>& changes) {
  const lab::ProfileSummary summary = lab::summary_of(profile);
  lab::Results results{"profile", BINOSPLAT_VERSION, {lab::profile_point(profile, summary)}};
  const nlohmann::ordered_json json =
      to_json(results, {{"suite_name", "profile"}, {"program", BINOSPLAT_VERSION}});
  std::deque<OutputFile> files;
  const auto next_file = [&]() -> lab::Write {
    OutputFile& file = files.emplace_back(folder / profile_files[files.size()]);
    return [&file](std::string_view text) { file.write(text); };
  };
  next_file()(lab::html(with_command(lab::profile_page(profile, summary, changes)), json));
  lab::write_trace(profile, next_file());
  lab::write_frames(profile.recording, next_file());
  next_file()(json_text(json));
  next_file()(lab::csv(results.points));
  // Flush all files before the first one gets its name, so that a full disk leaves none.
  for (OutputFile& file : files) file.flush();
  for (OutputFile& file : files) file.commit();
}

void save_recording(const std::filesystem::path& folder, const lab::ProfileFacts& facts,
                    render::Recording recording, const DrawAgain& draw) {
  constexpr double wait_ms = 1000.0;
  lab::Profile profile{.facts = facts, .recording = std::move(recording)};
  const lab::ProfileSummary summary = lab::summary_of(profile);
  const Clock::time_point begin = Clock::now();
  for (const std::size_t n : summary.worst) {
    if (!draw || ms_since(begin) > wait_ms) break;
    profile.pictures.emplace_back(
        lab::for_page(draw(profile.recording.frames[n].views.front()), lab::worst_picture_width));
  }
  save_profile(folder, profile, {});
  for (const std::string& line : lab::lines_of(profile, summary)) log_info("{}", line);
}

}  // namespace binosplat::app
