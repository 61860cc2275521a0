// Checks spz files with Niantic's library. `spz_judge write FOLDER` writes a model in every coordinate system
// and version as NAME.spz, and as NAME.ply what the library reads from it. `spz_judge read IN.spz OUT.ply`
// converts a file of binosplat.
#include <cstdio>
#include <memory>
#include <random>
#include <string>

#include <cc/coordinate-system-adobe.h>
#include <cc/load-spz.h>

namespace {

spz::GaussianCloud some_cloud(int degree) {
  std::mt19937 random(degree);
  std::uniform_real_distribution<float> share(-1, 1);
  spz::GaussianCloud cloud;
  cloud.numPoints = 200;
  cloud.shDegree = degree;
  const auto fill = [&](std::vector<float>& values, int each, float least, float most) {
    for (int i = 0; i < each * cloud.numPoints; ++i)
      values.push_back(least + (most - least) * 0.5f * (1 + share(random)));
  };
  fill(cloud.positions, 3, -20, 20);
  fill(cloud.scales, 3, -6, 1);
  fill(cloud.rotations, 4, -1, 1);
  fill(cloud.alphas, 1, -4, 4);
  fill(cloud.colors, 3, -2, 2);
  fill(cloud.sh, 3 * ((degree + 1) * (degree + 1) - 1), -0.9f, 0.9f);
  return cloud;
}

bool to_ply(const std::string& in, const std::string& out) {
  spz::UnpackOptions unpack;
  unpack.to = spz::CoordinateSystem::RDF;
  spz::PackOptions pack;
  pack.from = spz::CoordinateSystem::RDF;
  return spz::saveSplatToPly(spz::loadSpz(in, unpack), pack, out);
}

bool write_all(const std::string& folder) {
  for (unsigned version = 2; version <= 4; ++version) {
    // Before version 4, the library does not find its own extension in a file.
    for (unsigned system = 0; system <= (version < 4 ? 0u : 16u); ++system) {
      for (int degree = 0; degree <= 3; ++degree) {
        spz::GaussianCloud cloud = some_cloud(degree);
        const auto stored = static_cast<spz::CoordinateSystem>(system);
        if (system > 0) {
          const auto extension = std::make_shared<spz::SpzExtensionCoordinateSystemAdobe>();
          extension->coordinateSystem = stored;
          cloud.extensions.push_back(extension);
        }
        spz::PackOptions pack;
        pack.version = version;
        pack.from = spz::CoordinateSystem::RDF;
        const std::string name = folder + "/v" + std::to_string(version) + "-system" +
                                 std::to_string(system) + "-degree" + std::to_string(degree);
        if (!spz::saveSpz(cloud, pack, name + ".spz") || !to_ply(name + ".spz", name + ".ply")) return false;
      }
    }
  }
  return true;
}

}  // namespace

int main(int count, char** words) {
  const std::string command = count > 1 ? words[1] : "";
  if (command == "write" && count == 3) return write_all(words[2]) ? 0 : 1;
  if (command == "read" && count == 4) return to_ply(words[2], words[3]) ? 0 : 1;
  std::puts("spz_judge write FOLDER | read IN.spz OUT.ply");
  return 2;
}
