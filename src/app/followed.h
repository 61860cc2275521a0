#pragma once
// Levels of detail: those that --gpu-memory has room for, and with --detail those that follow what is drawn.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "app/render_options.h"
#include "app/shots.h"
#include "stream/load_within.h"
#include "stream/picture_stream.h"
#include "stream/stream.h"

namespace binosplat::app {

/// How many Gaussians of a degree fit in so many MB beside what a frame of these views takes, and what their
/// uploads do where they come `in_parts`.
std::size_t gaussians_that_fit(double megabytes, render::FrameSettings settings,
                               std::span<const shared::View> views, int degree, bool in_parts);

/// How many Gaussians fit in --gpu-memory beside what a frame of the views takes, and from where the
/// views see the model, both eyes: known before it is read, unless its own place decides (--orbit, no
/// cameras), where no eye counts.
DetailBudget detail_budget(const RenderOptions& options, const CameraList& list);

/// Opens a scene, with axes and anti-aliasing as options say, for frames that must not wait, which begin with
/// the coarsest levels while the others are read; null where no levels follow what is seen.
std::unique_ptr<Stream> open_for_frames(const SceneOptions& options, const render::FrameSettings& settings);

/// The same for shots that may wait, of a head that turns, or single pictures: those with little memory, or a
/// --detail, go by dB however few Gaussians there are. Throws Error where the scene is no streamed SOG.
std::unique_ptr<PictureStream> open_for_shots(const SceneOptions& options,
                                              const render::FrameSettings& settings, bool heads_turn);

}  // namespace binosplat::app
