"""Two blocks of C3D20 that do not match, pressed at one side so that they part at the other: CalculiX's own static contact (face to face, linear)."""
import numpy as np, sys, subprocess
def block(first, cells, lo, hi):
    nodes, elems, num = {}, [], {}
    LN=[(-1,-1,-1),(1,-1,-1),(1,1,-1),(-1,1,-1),(-1,-1,1),(1,-1,1),(1,1,1),(-1,1,1),(0,-1,-1),(1,0,-1),(0,1,-1),(-1,0,-1),(0,-1,1),(1,0,1),(0,1,1),(-1,0,1),(-1,-1,0),(1,-1,0),(1,1,0),(-1,1,0)]
    for k in range(cells[2]):
        for j in range(cells[1]):
            for i in range(cells[0]):
                con=[]
                for c in LN:
                    key=(2*i+1+c[0],2*j+1+c[1],2*k+1+c[2])
                    if key not in num:
                        num[key]=first+len(num)
                        nodes[num[key]]=tuple(lo[x]+(hi[x]-lo[x])*key[x]/2/cells[x] for x in range(3))
                    con.append(num[key])
                elems.append(con)
    return nodes, elems
def run(name, upper, lower, c, e0=0.75, hold="bottom"):
    un,ue=block(1,upper,(0,0,0),(1,1,.4)); ln,le=block(10001,lower,(0,0,-.5),(1,1,0))
    f=open(name+".inp","w"); w=lambda s: f.write(s+"\n")
    w("*NODE")
    for d in (un,ln):
        for k,p in d.items(): w("%d, %.12g, %.12g, %.12g"%((k,)+p))
    e=0; sl=[]; ma=[]; top=[]
    for nm,elems,nodes in (("UP",ue,un),("LO",le,ln)):
        w("*ELEMENT, TYPE=C3D20, ELSET="+nm)
        for con in elems:
            e+=1; w(", ".join(map(str,[e]+con[:15]))+","); w(", ".join(map(str,con[15:])))
            zs=[nodes[k][2] for k in con]
            if nm=="UP" and min(zs)==0: sl.append(e)
            if nm=="LO" and max(zs)==0: ma.append(e)
            if nm=="UP" and abs(max(zs)-.4)<1e-12 and min(nodes[k][0] for k in con)>=e0-1e-9: top.append(e)
    w("*ELSET, ELSET=TOP"); [w(str(x)) for x in top]
    w("*SURFACE, NAME=S"); [w("%d, S1"%x) for x in sl]
    w("*SURFACE, NAME=M"); [w("%d, S2"%x) for x in ma]
    w("*MATERIAL, NAME=A\n*ELASTIC\n100., .3\n*SOLID SECTION, ELSET=UP, MATERIAL=A\n*SOLID SECTION, ELSET=LO, MATERIAL=A")
    w("*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n%g, 1e-12"%c)
    w("*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nS, M")
    w("*BOUNDARY")
    for k,p in ln.items():
        if abs(p[2]+.5)<1e-12: w("%d, 1, 3"%k)
    for k,p in un.items():
        if p[2]==0 and p[0]==0 and p[1]==0: w("%d, 1, 2"%k)
        if p[2]==0 and p[0]==0 and p[1]==1: w("%d, 1, 1"%k)
    w("*STEP\n*STATIC\n1., 1.\n*DLOAD\nTOP, P2, 0.001\n*NODE PRINT, NSET=NALL\nU\n*CONTACT FILE\nCDIS, CSTR\n*NODE FILE\nU\n*END STEP")
    f.close()
    s=open(name+".inp").read().replace("*NODE\n","*NODE, NSET=NALL\n",1); open(name+".inp","w").write(s)
    out=subprocess.run(["ccx","-i",name],capture_output=True,text=True).stdout
    open(name+".log","w").write(out)
    xyz={**un,**ln}; res={}
    for l in open(name+".dat"):
        t=l.split()
        if len(t)==4 and t[0].isdigit(): res[int(t[0])]=tuple(map(float,t[1:]))
    return xyz,res
if __name__=="__main__":
    for nm,up,lo,c in (("tilt",(4,2,1),(3,3,1),50.),("fine",(8,3,2),(6,4,2),50.),("stiff",(8,3,2),(6,4,2),500.)):
        xyz,res=run(nm,up,lo,c)
        with open(nm+".txt","w") as f:
            f.write("# CalculiX 2.x, %s on %s cells of C3D20, slope %g, pressure 0.001 on the top from x = 0.75: x y z ux uy uz\n"%(up,lo,c))
            for k in sorted(res):
                if k<10000 and abs(xyz[k][2]-.4)<1e-12: f.write("%g %g %g %.7e %.7e %.7e\n"%(xyz[k]+res[k]))
