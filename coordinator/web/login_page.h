// The page that asks for a token. It shows nothing about the farm and loads nothing.
#pragma once

#include <string>

namespace tessera {

// A constant, so that the Content-Security-Policy can name its digest.
inline constexpr const char* kLoginStyle = R"(
:root{color-scheme:light dark;--ink:#1a1f2b;--soft:#5b6478;--line:#d9dee8;--card:#fff;--back:#f3f5f9;--bar:#1f5fd0;
--on-bar:#fff;--bad:#b3261e}
@media(prefers-color-scheme:dark){:root{--ink:#e8ebf2;--soft:#9aa5ba;--line:#2c3444;--card:#181d27;--back:#0f131a;
--bar:#7eb0ff;--on-bar:#0b1220;--bad:#ff8a80}}
*{box-sizing:border-box}body{margin:0;padding:28px 16px;background:var(--back);color:var(--ink);
font:15px/1.5 system-ui,sans-serif}h1{font-size:20px;margin:0}
.login{max-width:460px;margin:12vh auto 0;background:var(--card);border:1px solid var(--line);border-radius:12px;
padding:24px 28px}.login label{display:block;margin:16px 0 6px;color:var(--soft)}
.login input[type=password]{width:100%;padding:10px 12px;font:inherit;color:inherit;background:var(--card);
border:1px solid var(--soft);border-radius:8px}.hint{margin:16px 0 0;color:var(--soft)}.error{color:var(--bad)}
button{font:inherit;padding:8px 18px;margin-top:16px;border:0;border-radius:8px;background:var(--bar);
color:var(--on-bar);cursor:pointer}:focus-visible{outline:3px solid var(--bar);outline-offset:2px}
)";

// `proof` comes back with the form.
std::string LoginPage(const std::string& proof, const std::string& problem);

}  // namespace tessera
