#include "adagscale/calibration_file.h"

#include <gtest/gtest.h>

#include "support/broken.h"
#include "support/calibration.h"

namespace binosplat::adagscale {
namespace {

using nlohmann::json;
using test::sample_calibration;

TEST(CalibrationFile, RoundTrips) {
  const std::string text = json_of(sample_calibration()).dump();
  const ThresholdCalibration read = parse_calibration("c.json", text);
  EXPECT_EQ(json_of(read).dump(), text);
  EXPECT_EQ(read.hash, sample_calibration().hash);
  EXPECT_EQ(read.perspective, sample_calibration().perspective);
  EXPECT_EQ(read.target.kind, CalibrationTarget::Kind::drop);
  EXPECT_EQ(read.entries[1].transmittance, Transmittance::last);
  EXPECT_EQ(read.depth_table.bounds, sample_calibration().depth_table.bounds);
  EXPECT_EQ(read.reach, 6.0);
  ThresholdCalibration other = sample_calibration();
  other.target.kind = CalibrationTarget::Kind::quality;
  EXPECT_EQ(parse_calibration("c", json_of(other).dump()).target.kind, CalibrationTarget::Kind::quality);
}

TEST(CalibrationFile, ErrorsNameKey) {
  const auto with = [](const char* pointer, const json& value) {
    return test::with_value(json::parse(json_of(sample_calibration()).dump()), pointer, value);
  };
  // The nesting is so deep that writing the value into the error recursively would overflow the stack.
  const std::string deep = std::string(300000, '[') + std::string(300000, ']');
  const std::vector<test::BrokenFile> refusals = {
      {with("/format", "other"), {"not a calibration of this version"}},
      {with("/version", 1), {"not a calibration of this version"}},
      {with("/model/hash", "12"), {"key 'model.hash': 12: expected 16 hexadecimal digits"}},
      {with("/model", 5), {"key 'model': expected an object"}},
      {with("/focal_px", 0), {"key 'focal_px': 0: expected a number of"}},
      {with("/depth_table/upper", {0.5, 1.5}),
       {"'depth_table.upper[1]': 1.5: expected a number from 0 to 1"}},
      {with("/depth_table/upper", json::array()), {"expected 1 to"}},
      {with("/depth_table/far", "x"), {"key 'depth_table.far': expected a finite number"}},
      {with("/target", json::object()), {"psnr_db"}},
      {with("/reach", -1), {"key 'reach': -1: expected a number of 0 or more"}},
      {with("/views/1/position", {1, 2}), {"key 'views[1].position': expected 3 values"}},
      {with("/entries/0/threshold", "none"), {"'threshold': 'none' is not one of exact"}},
      {with("/entries/1/tolerance", -1), {"key 'entries[1].tolerance': -1: expected a number of 0 or more"}},
      {with("/entries/1/tolerance", 1e300), {"is too large"}},
      {with("/entries/0/transmittance", "both"), {"'transmittance': 'both' is not one of"}},
      {with("/entries", "many"), {"key 'entries': expected a list"}},
      {with("/entries/0/worst_view", nullptr), {"worst_view"}},
      {"{\"format\"", {"not valid JSON"}},
      {"[]", {}},
      {"{\"format\": " + deep + "}", {}},
  };
  test::expect_refusals("c.json", refusals, [](const auto& text) { parse_calibration("c.json", text); });
}

}  // namespace
}  // namespace binosplat::adagscale
