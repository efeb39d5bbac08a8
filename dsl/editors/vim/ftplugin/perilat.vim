if exists("b:did_ftplugin")
  finish
endif
let b:did_ftplugin = 1
setlocal comments=:!>,:! commentstring=!\ %s expandtab shiftwidth=2 softtabstop=2
let &l:formatprg = "perilat format /dev/stdin"
let b:undo_ftplugin = "setlocal comments< commentstring< expandtab< shiftwidth< softtabstop< formatprg<"
