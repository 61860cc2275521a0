#pragma once
// VR photos (.vr.jpg) of Google's VR180 cameras, which headsets' galleries recognise: a JPEG of the left eye.
// Its XMP declares half a sphere and contains the right eye's JPEG (GPano and GImage,
// https://developers.google.com/vr/reference/cardboard-camera-vr-photo-format).

#include <filesystem>
#include <string>

#include "base/image.h"

namespace binosplat {

/// Returns the bytes of a VR photo. The eyes' pictures are equirectangular, of one size, RGB, and cover 180
/// degrees across and down. Throws Error naming the file.
std::string vr_photo_bytes(const std::filesystem::path& path, const Image& left, const Image& right);

}  // namespace binosplat
