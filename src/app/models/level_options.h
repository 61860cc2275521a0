#pragma once
// Levels of detail: a fixed choice within --gpu-memory, or streams that follow the views (--detail).

#include <memory>
#include <span>

#include "app/options/options.h"
#include "app/render/shots.h"
#include "stream/load_within.h"
#include "stream/opened_model.h"
#include "stream/picture_stream.h"
#include "stream/stream.h"

namespace binosplat::app {

/// The number of Gaussians of a degree that fit into `megabytes` together with a frame of these views.
/// `in_parts` also reserves memory for the uploads of a stream.
std::size_t gaussians_that_fit(double megabytes, render::FrameSettings settings,
                               std::span<const shared::View> views, int degree, bool in_parts);

/// Returns, from options and cameras alone, the number of Gaussians that fit into --gpu-memory, and the eyes'
/// positions. Without cameras or with --orbit the model decides the views, so `eyes` is empty.
DetailBudget detail_budget(const Options& options, const CameraList& list);

/// Opens a model for frames that must not wait: as a stream, which starts with the coarsest levels, if levels
/// follow the views; else whole, as load_scene() does. Applies the options' axes and anti-aliasing.
OpenedModel<Stream> open_for_frames(const SceneOptions& options, const render::FrameSettings& settings,
                                    std::span<const Camera> cameras);

/// Opens a stream for pictures that may wait for their levels. `heads_turn` also refines chunks out of view.
/// With --gpu-memory or --detail, even small models are drawn at chosen levels instead of the finest. Throws
/// Error if the scene is not a streamed SOG.
std::unique_ptr<PictureStream> open_for_shots(const SceneOptions& options,
                                              const render::FrameSettings& settings, bool heads_turn);

}  // namespace binosplat::app
