#pragma once
// A page in headless Chromium, as a reader has it: at a width, in light or dark. Needs the program `chromium`
// (Debian's package of that name; packages/long.txt).

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/program.h"

namespace binosplat::test {

inline bool has_chromium() { return std::system("command -v chromium > /dev/null 2>&1") == 0; }

class Chromium {
 public:
  /// What `script`, the body of a function of (document, window), returns as text about the page when it is
  /// `width` px wide. It may await.
  std::string ask(const std::filesystem::path& page, int width, bool dark, const std::string& script) const {
    const std::filesystem::path harness = folder_ / "harness.html";
    write_text(harness, "<!doctype html><iframe id=f style='border:0;width:" + std::to_string(width) +
                            "px;height:3000px' src='file://" + std::filesystem::absolute(page).string() +
                            "'></iframe><pre id=answer>none</pre><script>onload = async () => {\n"
                            "const frame = document.getElementById('f').contentWindow;\n"
                            "await new Promise((done) => setTimeout(done, 500));\n"
                            "const look = async (document, window) => {" +
                            script +
                            "};\nlet text; try { text = String(await look(frame.document, frame)); }"
                            " catch (error) { text = 'failed: ' + error; }\n"
                            "document.getElementById('answer').textContent = 'ANSWER' + '[' + text + ']' + "
                            "'END'; };</script>");
    const std::string out =
        run("--allow-file-access-from-files --virtual-time-budget=20000 --dump-dom", harness, dark);
    const std::size_t begin = out.rfind("ANSWER["), end = out.rfind("]END");
    if (begin == std::string::npos || end == std::string::npos || end < begin) return "no answer: " + out;
    return out.substr(begin + 7, end - begin - 7);
  }

  /// A picture of the page's first `height` px.
  void screenshot(const std::filesystem::path& page, int width, int height, bool dark,
                  const std::filesystem::path& png) const {
    run("--hide-scrollbars --virtual-time-budget=10000 --window-size=" + std::to_string(width) + "," +
            std::to_string(height) + " --screenshot='" + png.string() + "'",
        page, dark);
  }

 private:
  std::string run(const std::string& options, const std::filesystem::path& page, bool dark) const {
    const std::string said = folder_ / "said.txt";
    const std::string command =
        "chromium --headless --no-sandbox --disable-gpu --user-data-dir='" + (folder_ / "profile").string() +
        "' --blink-settings=preferredColorScheme=" + (dark ? "0 " : "1 ") + options + " 'file://" +
        std::filesystem::absolute(page).string() + "' > '" + said + "' 2> /dev/null";
    if (std::system(command.c_str()) != 0) return "chromium failed";
    return read_text(said);
  }

  TempFolder folder_;
};

}  // namespace binosplat::test
