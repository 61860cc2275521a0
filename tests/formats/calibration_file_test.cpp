#include "formats/calibration_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "support/calibration.h"

namespace binosplat {
namespace {

using nlohmann::ordered_json;
using test::sample_calibration;

TEST(CalibrationFile, ComesBackAsItWas) {
  const std::string text = json_of(sample_calibration()).dump();
  const ThresholdCalibration read = parse_calibration("c.json", text);
  EXPECT_EQ(json_of(read).dump(), text);
  EXPECT_EQ(read.hash, sample_calibration().hash);
  EXPECT_EQ(read.perspective, sample_calibration().perspective);
  EXPECT_EQ(read.target.kind, CalibrationTarget::Kind::drop);
  EXPECT_EQ(read.entries[1].transmittance, TRANSMITTANCE_LAST);
  EXPECT_EQ(read.depth_table.bounds, sample_calibration().depth_table.bounds);
  ThresholdCalibration other = sample_calibration();
  other.target.kind = CalibrationTarget::Kind::quality;
  EXPECT_EQ(parse_calibration("c", json_of(other).dump()).target.kind, CalibrationTarget::Kind::quality);
}

TEST(CalibrationFile, ErrorsNameTheKey) {
  const struct {
    const char* path;
    ordered_json value;
    const char* said;
  } cases[] = {
      {"/format", "other", "not a calibration of this version"},
      {"/version", 2, "not a calibration of this version"},
      {"/model/hash", "12", "key 'model.hash': 12: expected 16 hexadecimal digits"},
      {"/model", 5, "key 'model': expected an object"},
      {"/focal_px", 0, "key 'focal_px': 0: expected a number of"},
      {"/depth_table/upper", {0.5, 1.5}, "key 'depth_table.upper[1]': 1.5: expected a number from 0 to 1"},
      {"/depth_table/upper", ordered_json::array(), "expected 1 to"},
      {"/depth_table/far", "x", "key 'depth_table.far': expected a finite number"},
      {"/target", ordered_json::object(), "psnr_db"},
      {"/views/1/position", {1, 2}, "key 'views[1].position': expected 3 values"},
      {"/entries/0/th", "none", "'th': 'none' is not one of tau"},
      {"/entries/1/tolerance", -1, "key 'entries[1].tolerance': -1: expected a number of 0 or more"},
      {"/entries/1/tolerance", 1e300, "is too large"},
      {"/entries/0/transmittance", "both", "'transmittance': 'both' is not one of"},
      {"/entries", "many", "key 'entries': expected a list"},
  };
  for (const auto& c : cases) {
    ordered_json json = json_of(sample_calibration());
    json[ordered_json::json_pointer(c.path)] = c.value;
    try {
      parse_calibration("c.json", json.dump());
      ADD_FAILURE() << "accepted " << c.path << " " << c.value;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).substr(0, 6), "c.json");
      EXPECT_NE(std::string(error.what()).find(c.said), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(parse_calibration("c", "{\"format\""), Error);
  EXPECT_THROW(parse_calibration("c", "[]"), Error);
  // So deep that writing it into the error would leave the stack.
  const std::string deep = std::string(300000, '[') + std::string(300000, ']');
  EXPECT_THROW(parse_calibration("c", "{\"format\": " + deep + "}"), Error);
  ordered_json json = json_of(sample_calibration());
  json["entries"][0].erase("worst_view");
  EXPECT_THROW(parse_calibration("c", json.dump()), Error);
}

}  // namespace
}  // namespace binosplat
