#include "app/measured_options.h"

#include "app/option_checks.h"

namespace binosplat::app {

void add_measured_options(CLI::App& sub, MeasuredOptions& o) {
  add_near_option(sub, o.camera);
  add_count_option(sub, o.scene);
  add_seed_option(sub, o.scene);
  choose<gl::Backend>(sub, "--backend", o.context.backend, "A GPU, else Mesa; or Mesa without a GPU (auto)",
                      {{"auto", gl::Backend::automatic}, {"surfaceless", gl::Backend::surfaceless}});
  add_device_option(sub, o.context);
}

}  // namespace binosplat::app
