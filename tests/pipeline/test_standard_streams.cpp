#include <gtest/gtest.h>

#include <iostream>
#include <sstream>

#include "pipeline/standard_streams.h"

namespace morphodesic::pipeline {
namespace {

TEST(StandardStreams, ControlCharactersAreShownNotSent) {
    EXPECT_EQ(printable("a\x1b[31mb\r\x7f.png: caf\xc3\xa9\tx\n"), "a\\x1b[31mb\\x0d\\x7f.png: caf\xc3\xa9\tx\n");
    EXPECT_EQ(printable("\xc2\x9b"
                        "2J \xc2\xa0 \xc2"),
              "\\xc2\\x9b2J \xc2\xa0 \xc2");
    EXPECT_EQ(printable(std::string_view("\0", 1)), "\\x00");
    EXPECT_EQ(printable("\xf0\x9f\x90\x9f \xff"), "\xf0\x9f\x90\x9f \xff");  // bytes that are no text stay as they are
}

TEST(StandardStreams, ErrorsArePrintableWhileTheFilterLives) {
    std::ostringstream out;
    std::streambuf* const terminal = std::cerr.rdbuf(out.rdbuf());
    {
        const PrintableErrors filter;
        std::cerr << "name\x1b" << '\x07' << 7 << std::endl;
    }
    std::cerr << "\x1b";
    std::cerr.rdbuf(terminal);
    EXPECT_EQ(out.str(), "name\\x1b\\x077\n\x1b");
}

}  // namespace
}  // namespace morphodesic::pipeline
