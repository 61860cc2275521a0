#pragma once
// A page in headless Chromium, as a reader sees it: at a width, in light or dark mode. Needs the program
// `chromium` (Debian's package of that name; packages/long.txt).

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/program.h"
#include "support/scenes.h"

namespace binosplat::test {

/// Tests of pages in Chromium, which only the long check runs. A test first writes its page into `file`.
struct InChromium : testing::Test {
  TempFolder folder;
  const std::filesystem::path file = folder / "page.html";

  void SetUp() override {
    if (!switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "BINOSPLAT_LONG=1 opens the page in Chromium";
    ASSERT_EQ(std::system("command -v chromium > /dev/null 2>&1"), 0)
        << "install the package chromium (packages/long.txt)";
  }

  /// Runs `script`, the body of a function of (document, window), in the page at a width of `width` px.
  /// Returns the text that it returns. It may await.
  std::string ask(const std::string& script, int width = 1280, bool dark = false) const {
    const std::filesystem::path harness = folder / "harness.html";
    write_text(harness, "<!doctype html><iframe id=f style='border:0;width:" + std::to_string(width) +
                            "px;height:3000px' src='file://" + std::filesystem::absolute(file).string() +
                            "'></iframe><pre id=answer>none</pre><script>onload = async () => {\n"
                            "const frame = document.getElementById('f').contentWindow;\n"
                            "await new Promise((done) => setTimeout(done, 500));\n"
                            "const look = async (document, window) => {" +
                            script +
                            "};\nlet text; try { text = String(await look(frame.document, frame)); }"
                            " catch (error) { text = 'failed: ' + error; }\n"
                            "document.getElementById('answer').textContent = 'ANSWER' + '[' + text + ']' + "
                            "'END'; };</script>");
    const std::string said = folder / "said.txt";
    const std::string command =
        "chromium --headless --no-sandbox --disable-gpu --user-data-dir='" + (folder / "profile").string() +
        "' --blink-settings=preferredColorScheme=" + (dark ? "0" : "1") +
        " --allow-file-access-from-files --virtual-time-budget=20000 --dump-dom 'file://" + harness.string() +
        "' > '" + said + "' 2> /dev/null";
    if (std::system(command.c_str()) != 0) return "chromium failed";
    const std::string out = read_text(said);
    const std::size_t begin = out.rfind("ANSWER["), end = out.rfind("]END");
    if (begin == std::string::npos || end == std::string::npos || end < begin) return "no answer: " + out;
    return out.substr(begin + 7, end - begin - 7);
  }
};

}  // namespace binosplat::test
