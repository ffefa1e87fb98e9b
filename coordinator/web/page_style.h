// The style sheet of all pages. A constant, so that the Content-Security-Policy can name its digest.
#pragma once

namespace tessera {

inline constexpr const char* kPageStyle = R"(
:root{color-scheme:light dark;--ink:#1c2330;--soft:#6a7386;--line:#e3e7ee;--card:#fff;--back:#f4f6f9;--bar:#2f6fde;
--good:#1f9d61;--bad:#d0433f;--warn:#c98a10}
@media(prefers-color-scheme:dark){:root{--ink:#e6eaf2;--soft:#939db1;--line:#2b3342;--card:#1a202b;--back:#11151c;
--bar:#5b93f5}}
*{box-sizing:border-box}body{margin:0;padding:28px 32px;background:var(--back);color:var(--ink);
font:14px/1.45 system-ui,sans-serif}h1{font-size:20px;margin:0}h2{font-size:15px;margin:28px 0 8px}
header{display:flex;align-items:center;gap:12px}header h1{flex:1}header form{margin:0}
.tiles{display:flex;flex-wrap:wrap;gap:12px;margin-top:18px}
.tile{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:10px 16px;min-width:130px}
.tile b{display:block;font-size:20px;font-variant-numeric:tabular-nums}.tile span,.none,small{color:var(--soft)}
table{width:100%;border-collapse:collapse;background:var(--card);border:1px solid var(--line);border-radius:10px;
overflow:hidden}th,td{padding:7px 12px;text-align:left;border-top:1px solid var(--line)}
th{border-top:0;color:var(--soft);font-weight:500;font-size:12px}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
.name{max-width:340px;overflow:hidden;text-overflow:ellipsis;white-space:nowrap}
progress{width:150px;height:8px;border:0;border-radius:4px;background:var(--line);overflow:hidden;margin-right:8px;
appearance:none;vertical-align:middle}progress::-webkit-progress-bar{background:var(--line)}
progress::-webkit-progress-value{background:var(--bar)}progress::-moz-progress-bar{background:var(--bar)}
.state{padding:1px 9px;border-radius:9px;background:var(--line);font-size:12px}
.running,.rendering{background:var(--bar);color:#fff}.finished{background:var(--good);color:#fff}
.failed,.quarantined{background:var(--bad);color:#fff}.paused,.draining{background:var(--warn);color:#fff}
.login{max-width:460px;margin:12vh auto 0;background:var(--card);border:1px solid var(--line);border-radius:10px;
padding:24px 28px}.login label{display:block;margin:16px 0 6px;color:var(--soft)}
.login input[type=password]{width:100%;padding:8px 10px;font:inherit;color:inherit;background:var(--back);
border:1px solid var(--line);border-radius:6px}.error{color:var(--bad)}
button{font:inherit;padding:6px 16px;margin-top:14px;border:0;border-radius:6px;background:var(--bar);color:#fff;
cursor:pointer}header button{margin:0;background:var(--line);color:var(--ink)}
)";

}  // namespace tessera
