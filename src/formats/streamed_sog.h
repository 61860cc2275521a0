#pragma once
// Streamed SOG: several SOGs and a lod-meta.json, which says which of their Gaussians are which part of the
// model at which level of detail. Frame: the trainer's (RDF).

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "formats/detail.h"
#include "formats/sog_levels.h"
#include "scene/model.h"
#include "shared/types.h"

namespace binosplat {

/// Whether a JSON file is a lod-meta.json.
bool is_sog_levels(const nlohmann::json& root);

/// Whether a path names a lod-meta.json, or the folder of one.
bool is_streamed_sog(const std::filesystem::path& path);

/// Reads one level of detail, 0 being the finest, and the environment, which belongs to every level. Without
/// `lod`: the finest of which all files are there, which is said where it is not 0. With a `budget`, which
/// counts then, each leaf of the tree has a level of its own (formats/detail.h), among those whose files are
/// there. Gaussians come in the order of the files and of the Gaussians in them. Throws Error as load_sog
/// does, and for a level that there is not.
Model load_streamed_sog(const std::filesystem::path& lod_meta, const nlohmann::json& root,
                        std::optional<int> lod, const std::optional<DetailBudget>& budget = {});

/// A streamed SOG whose leaves change their levels as somebody moves through it. choose() and read() may be
/// called by different threads, but not at a time.
class StreamedSog {
 public:
  /// `path`: a lod-meta.json or the folder of one. Opens what is there of its SOGs. Throws Error as
  /// load_streamed_sog does, and where it is anything else.
  explicit StreamedSog(const std::filesystem::path& path);
  ~StreamedSog();

  int degree() const { return degree_; }

  /// Chooses a level for each leaf: the same for all views, which are those of one frame in the model's
  /// frame; by the nearest eye and the longest focal length of them, wherever they look (choose_levels), or
  /// by what each of them loses (choose_levels_within), with the levels of the last choice as those before.
  /// Without views: the coarsest. True if the model that was read last is another one. Throws Error for dB
  /// where the file has no errors.
  /// `seen`: what each view shows of each of ranges(), as far as that was found (choose_levels_within).
  bool choose(std::span<const shared::View> views, const DetailNeed& need,
              std::span<const std::vector<SeenPart>> seen = {});

  /// What the views are taken to have against the finest levels, in dB; none where dB were not chosen by.
  std::optional<double> predicted_psnr() const { return predicted_psnr_; }

  /// The model at the levels chosen. Only leaves whose level has changed are read, the others come from the
  /// last model, a copy of which stays here. Throws Error where a file has become unreadable.
  Model read();

  /// Which Gaussians of the model that was read last are which leaf, and at the end the environment.
  struct Range {
    std::size_t first = 0, count = 0;
  };
  std::span<const Range> ranges() const { return ranges_; }

 private:
  struct Source;
  void fill(Model& model, std::vector<std::uint8_t>& kept, std::span<const SogLevels::Taken> taken,
            std::size_t file) const;
  static void close_gaps(std::vector<Range>& ranges, const std::vector<std::uint8_t>& kept);

  std::unique_ptr<Source> source_;
  std::vector<DetailPart> leaves_;
  int degree_ = 0;
  std::vector<std::size_t> chosen_;  // places in a leaf's `levels`
  bool by_views_ = false;            // chosen
  std::optional<double> predicted_psnr_;
  // The last model, the levels that it has, and where its leaves lie; the environment lies last.
  Model model_;
  std::vector<std::size_t> levels_;
  std::vector<Range> ranges_;
};

}  // namespace binosplat
