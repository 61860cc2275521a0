#pragma once
// VR photos (.vr.jpg), as Google's VR180 cameras leave them and headsets' galleries know them: a JPEG of the
// left eye whose XMP says that it is half a sphere and holds the right eye's JPEG (GPano and GImage,
// https://developers.google.com/vr/reference/cardboard-camera-vr-photo-format). Readers that do not know XMP
// show the left eye.

#include <filesystem>
#include <string>

#include "base/image.h"

namespace binosplat {

/// The bytes of two equirectangular pictures, of one size, of 180 degrees across and down, RGB. Throws Error
/// naming the file.
std::string vr_photo_bytes(const std::filesystem::path& path, const Image& left, const Image& right);

}  // namespace binosplat
