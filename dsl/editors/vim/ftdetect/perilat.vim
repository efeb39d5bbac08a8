autocmd BufNewFile,BufRead *.plm set filetype=perilat
